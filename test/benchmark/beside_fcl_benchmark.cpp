// SPDX-License-Identifier: BSD-3-Clause
// The time of a distance query and its errors beside FCL's and libccd's: the same pairs in the same run, pair
// by pair in turns, nothing kept from one query to the next. All are asked for the signed gap and its
// direction; FCL with its two solvers and its own tolerances, libccd, which knows depths but no distances, by
// GJK and by MPR with the tolerances of CCD_INIT. The truth is that of test/core/hard_pairs.h.
#include "core/hard_pairs.h"
#include "narrowphase/collide.h"

#include <ccd/ccd.h>
#include <ccd/quat.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <chrono>
#include <csetjmp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace rbs;
using oracle::Pair;

constexpr int kPairs = 500, kRounds = 5;
constexpr std::uint64_t kSeed = 1;

/// What a library says of a pair: the gap and its direction, or no more than whether they meet.
struct Answer {
  double gap = 0.0;
  Vec3 n = Vec3::Zero();
  bool only_sign = false;  ///< no more is known of `gap` than whether it is above 0
};

Answer whetherTheyMeet(bool they_do) {
  return {they_do ? -1.0 : 1.0, Vec3::Zero(), true};
}

/// A library, ready to be asked about one pair.
using Question = std::function<Answer()>;

Question askOurs(const Pair& pair) {
  return [&pair] {
    const Gap found = gap(pair.a, pair.X_WA, pair.b, pair.X_WB);
    return Answer{found.distance, found.n_W};
  };
}

Question askOursWhether(const Pair& pair) {
  return [&pair] { return whetherTheyMeet(areWithin(pair.a, pair.X_WA, pair.b, pair.X_WB, 0.0)); };
}

std::shared_ptr<fcl::CollisionGeometryd> fclShape(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return std::make_shared<fcl::Sphered>(s->radius);
  if (const auto* s = std::get_if<Box>(&shape)) return std::make_shared<fcl::Boxd>(s->size);
  if (const auto* s = std::get_if<Capsule>(&shape))
    return std::make_shared<fcl::Capsuled>(s->radius, 2.0 * s->half_length);
  if (const auto* s = std::get_if<Cylinder>(&shape))
    return std::make_shared<fcl::Cylinderd>(s->radius, 2.0 * s->half_length);
  const Polyhedron& polyhedron = *std::get<ConvexHull>(shape).polyhedron;
  auto faces = std::make_shared<std::vector<int>>();
  for (const Polyhedron::Face& face : polyhedron.faces) {
    faces->push_back(static_cast<int>(face.corners.size()));
    faces->insert(faces->end(), face.corners.begin(), face.corners.end());
  }
  return std::make_shared<fcl::Convexd>(std::make_shared<std::vector<Vec3>>(polyhedron.vertices),
                                        static_cast<int>(polyhedron.faces.size()), faces);
}

fcl::Transform3d fclPose(const Pose& pose) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = pose.q_WB.toRotationMatrix();
  X.translation() = pose.p_WB;
  return X;
}

/// The libccd solver gives signed distances; for its own solver FCL has none, only the deepest contact of
/// collide().
Question askFcl(const Pair& pair, fcl::GJKSolverType solver) {
  const auto a = fclShape(pair.a), b = fclShape(pair.b);
  const fcl::Transform3d X_WA = fclPose(pair.X_WA), X_WB = fclPose(pair.X_WB);
  fcl::DistanceRequestd request(true, solver == fcl::GST_LIBCCD);
  request.gjk_solver_type = solver;
  fcl::CollisionRequestd contacts(8, true);
  contacts.gjk_solver_type = solver;
  return [=] {
    fcl::DistanceResultd result;
    fcl::distance(a.get(), X_WA, b.get(), X_WB, request, result);
    if (solver == fcl::GST_INDEP && result.min_distance <= 0.0) {
      fcl::CollisionResultd met;
      fcl::collide(a.get(), X_WA, b.get(), X_WB, contacts, met);
      Answer deepest{0.0, Vec3::Constant(std::numeric_limits<double>::quiet_NaN())};
      for (std::size_t k = 0; k < met.numContacts(); ++k) {  // the sign of the depth depends on the shapes
        const double depth = std::abs(met.getContact(k).penetration_depth);
        if (-depth < deepest.gap) deepest = {-depth, met.getContact(k).normal};
      }
      return deepest;
    }
    const Vec3 r = result.nearest_points[1] - result.nearest_points[0];
    return Answer{result.min_distance, (result.min_distance < 0.0 ? -1.0 : 1.0) * r.normalized()};
  };
}

Question askFclWhether(const Pair& pair, fcl::GJKSolverType solver) {
  const auto a = fclShape(pair.a), b = fclShape(pair.b);
  const fcl::Transform3d X_WA = fclPose(pair.X_WA), X_WB = fclPose(pair.X_WB);
  fcl::CollisionRequestd request(1, false);
  request.gjk_solver_type = solver;
  return [=] {
    fcl::CollisionResultd result;
    fcl::collide(a.get(), X_WA, b.get(), X_WB, request, result);
    return whetherTheyMeet(result.isCollision());
  };
}

/// A shape as libccd sees it: a support function.
struct CcdShape {
  Shape shape;
  Mat3 R;
  Vec3 p;
};
void ccdSupport(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& x = *static_cast<const CcdShape*>(object);
  const Vec3 n = x.R.transpose() * Vec3(direction->v[0], direction->v[1], direction->v[2]);
  Vec3 q = Vec3::Zero();
  const double across = std::hypot(n.x(), n.y());
  if (const auto* s = std::get_if<Box>(&x.shape)) {
    q = 0.5 * Vec3(std::copysign(s->size.x(), n.x()), std::copysign(s->size.y(), n.y()),
                   std::copysign(s->size.z(), n.z()));
  } else if (const auto* s = std::get_if<Sphere>(&x.shape)) {
    q = s->radius * n.normalized();
  } else if (const auto* s = std::get_if<Capsule>(&x.shape)) {
    q = s->radius * n.normalized() + Vec3(0, 0, std::copysign(s->half_length, n.z()));
  } else if (const auto* s = std::get_if<Cylinder>(&x.shape)) {
    q = Vec3(0, 0, std::copysign(s->half_length, n.z()));
    if (across > 0.0) q.head<2>() = s->radius / across * n.head<2>();
  } else {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec3& v : std::get<ConvexHull>(x.shape).polyhedron->vertices)
      if (const double along = n.dot(v); along > most) most = along, q = v;
  }
  const Vec3 q_W = x.p + x.R * q;
  ccdVec3Set(out, q_W.x(), q_W.y(), q_W.z());
}
void ccdCentre(const void* object, ccd_vec3_t* out) {
  const Vec3& p = static_cast<const CcdShape*>(object)->p;
  ccdVec3Set(out, p.x(), p.y(), p.z());
}

CcdShape ccdShape(const Shape& shape, const Pose& X_WB) {
  return {shape, X_WB.q_WB.toRotationMatrix(), X_WB.p_WB};
}
ccd_t ccdSettings(double tolerance) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccdSupport;
  ccd.center1 = ccd.center2 = ccdCentre;
  ccd.max_iterations = 500;
  ccd.epa_tolerance = ccd.mpr_tolerance = tolerance;
  return ccd;
}

Question askCcd(const Pair& pair, decltype(&ccdGJKPenetration) ask, double tolerance) {
  const CcdShape a = ccdShape(pair.a, pair.X_WA), b = ccdShape(pair.b, pair.X_WB);
  return [=] {
    const ccd_t ccd = ccdSettings(tolerance);
    ccd_real_t depth;
    ccd_vec3_t n, p;
    if (ask(&a, &b, &ccd, &depth, &n, &p) != 0) return whetherTheyMeet(false);
    return Answer{-depth, Vec3(n.v[0], n.v[1], n.v[2])};
  };
}

Question askCcdWhether(const Pair& pair, decltype(&ccdGJKIntersect) ask) {
  const CcdShape a = ccdShape(pair.a, pair.X_WA), b = ccdShape(pair.b, pair.X_WB);
  return [=] {
    const ccd_t ccd = ccdSettings(1e-4);
    return whetherTheyMeet(ask(&a, &b, &ccd) != 0);
  };
}

/// One library over all pairs of a kind.
struct Contestant {
  std::string name;
  std::function<Question(const Pair&)> ask;
  std::vector<double> nanoseconds = {};
  int wrong = 0, failed = 0;  ///< sign of the gap wrong by more than 1e-13 of the size; no finite answer
  std::vector<double> errors = {};  ///< of the gap where the sign is right, of the size
  std::vector<double> turned = {};  ///< of the gap along the normal that was found, of the size
};

// Every direction that somebody found is tried by the oracle too: what separates, separates.
void judgeAnswers(std::vector<Contestant>& contestants, const Pair& pair,
                  const std::vector<std::optional<Answer>>& answers) {
  const double size = oracle::sizeOf(pair);
  const auto sound = [](const std::optional<Answer>& answer) {
    return answer && std::isfinite(answer->gap) && answer->n.allFinite();
  };
  oracle::Real best = judge(pair, Vec3::UnitX()).truth.gap;
  std::vector<oracle::Real> along(answers.size());
  for (std::size_t c = 0; c < answers.size(); ++c) {
    if (!sound(answers[c]) || answers[c]->only_sign) continue;
    const oracle::Judged judged = judge(pair, answers[c]->n);
    along[c] = judged.along;
    best = std::max(best, judged.truth.gap);
  }
  const auto truth = static_cast<double>(best);
  for (std::size_t c = 0; c < answers.size(); ++c) {
    Contestant& contestant = contestants[c];
    if (!sound(answers[c])) {
      ++contestant.failed;
    } else if (std::abs(truth) > 1e-13 * size && (answers[c]->gap > 0.0) != (truth > 0.0)) {
      ++contestant.wrong;
    } else if (!answers[c]->only_sign) {
      contestant.errors.push_back(std::abs(answers[c]->gap - truth) / size);
      contestant.turned.push_back(static_cast<double>(std::abs(along[c] - best)) / size);
    }
  }
}

// The FCL of Debian is built with its assertions, and one that fails ends the process. It counts as no
// answer.
jmp_buf after_abort;
void onAbort(int /*signal*/) {
  std::longjmp(after_abort, 1);
}

std::optional<Answer> answerOf(const Question& question) {
  std::signal(SIGABRT, onAbort);
  if (setjmp(after_abort) != 0) {
    sigset_t aborts;
    sigemptyset(&aborts);
    sigaddset(&aborts, SIGABRT);
    sigprocmask(SIG_UNBLOCK, &aborts, nullptr);
    return std::nullopt;
  }
  try {
    return question();
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<Contestant> askedForTheGap() {
  return {{"rigid_body_sim", askOurs},
          {"FCL, libccd solver", [](const Pair& p) { return askFcl(p, fcl::GST_LIBCCD); }},
          {"FCL, own solver", [](const Pair& p) { return askFcl(p, fcl::GST_INDEP); }},
          {"libccd, EPA to 1e-4", [](const Pair& p) { return askCcd(p, ccdGJKPenetration, 1e-4); }},
          {"libccd, EPA to 1e-10", [](const Pair& p) { return askCcd(p, ccdGJKPenetration, 1e-10); }},
          {"libccd, MPR to 1e-4", [](const Pair& p) { return askCcd(p, ccdMPRPenetration, 1e-4); }}};
}

std::vector<Contestant> askedWhetherTheyMeet() {
  return {{"rigid_body_sim", askOursWhether},
          {"FCL, libccd solver", [](const Pair& p) { return askFclWhether(p, fcl::GST_LIBCCD); }},
          {"FCL, own solver", [](const Pair& p) { return askFclWhether(p, fcl::GST_INDEP); }},
          {"libccd, GJK", [](const Pair& p) { return askCcdWhether(p, ccdGJKIntersect); }},
          {"libccd, MPR", [](const Pair& p) { return askCcdWhether(p, ccdMPRIntersect); }}};
}

void race(const std::string& kind, const std::vector<Pair>& pairs, std::vector<Contestant> contestants) {
  std::vector<std::vector<Question>> questions(contestants.size());
  for (std::size_t c = 0; c < contestants.size(); ++c)
    for (const Pair& pair : pairs) questions[c].push_back(contestants[c].ask(pair));
  // The time of a pair is the least of the rounds; between two rounds all other pairs have been asked for.
  for (Contestant& c : contestants)
    c.nanoseconds.assign(pairs.size(), std::numeric_limits<double>::infinity());
  std::vector<std::optional<Answer>> answers(contestants.size());
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      for (std::size_t c = 0; c < contestants.size(); ++c) {
        const auto start = std::chrono::steady_clock::now();
        answers[c] = answerOf(questions[c][k]);
        const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
        contestants[c].nanoseconds[k] = std::min(contestants[c].nanoseconds[k], spent.count());
      }
      if (round == 0) judgeAnswers(contestants, pairs[k], answers);
    }
  for (const Contestant& c : contestants) {
    std::printf("| %s | %s | %.2f | %.2f | %d | %d |", kind.c_str(), c.name.c_str(),
                1e-3 * quantile(c.nanoseconds, 0.5), 1e-3 * quantile(c.nanoseconds, 0.99), c.wrong, c.failed);
    for (const auto* errors : {&c.errors, &c.turned})
      if (errors->empty())
        std::printf(" |");
      else
        std::printf(" %.0e, %.0e |", quantile(*errors, 0.5), quantile(*errors, 1.0));
    std::printf("\n");
  }
  std::fflush(stdout);
}

/// Sizes of 0.2 to 1, hulls of 20 points on a ball.
Shape ordinaryShape(oracle::Random& random, const std::string& kind) {
  const auto size = [&] { return random.uniform(0.2, 1.0); };
  if (kind == "sphere") return Sphere{0.5 * size()};
  if (kind == "box") return Box{{size(), size(), size()}};
  if (kind == "capsule") return Capsule{0.5 * size(), 0.5 * size()};
  if (kind == "cylinder") return Cylinder{0.5 * size(), 0.5 * size()};
  static std::vector<Shape> store;
  if (store.size() < 50) {
    std::vector<Vec3> points;
    const Vec3 half(0.5 * size(), 0.5 * size(), 0.5 * size());
    for (int k = 0; k < 20; ++k) points.push_back(half.cwiseProduct(random.direction()));
    store.push_back(oracle::hullShape(points));
    return store.back();
  }
  return store[static_cast<std::size_t>(random.below(50))];
}

std::vector<Pair> ordinaryPairs(const std::string& a, const std::string& b, bool overlapping) {
  oracle::Random random(kSeed);
  std::vector<Pair> pairs;
  while (pairs.size() < kPairs) {
    const Pair pair{ordinaryShape(random, a), ordinaryShape(random, b), random.pose(0.7), random.pose(0.7)};
    const double gap = static_cast<double>(judge(pair, Vec3::UnitX()).truth.gap);
    if ((gap < 0.0) == overlapping) pairs.push_back(pair);
  }
  return pairs;
}

void printHead() {
  std::printf(
      "| pairs | library | median, us | 99th percentile, us | wrong sign | failed | gap off by | gap along "
      "the normal "
      "off by |\n|---|---|--:|--:|--:|--:|--:|--:|\n");
}

void raceOrdinary(std::vector<Contestant> (*contestants)()) {
  const std::pair<const char*, const char*> kinds[] = {{"box", "box"},           {"hull", "hull"},
                                                       {"sphere", "box"},        {"capsule", "capsule"},
                                                       {"cylinder", "cylinder"}, {"cylinder", "box"}};
  printHead();
  for (const auto& [a, b] : kinds)
    for (const bool overlapping : {false, true})
      race(std::string(a) + ", " + b + (overlapping ? ", overlapping" : ", apart"),
           ordinaryPairs(a, b, overlapping), contestants());
}

void raceHard() {
  printHead();
  for (const char* kind : {"box", "hull"}) {
    oracle::Random random(kSeed);
    std::vector<Pair> pairs;
    for (int k = 0; k < kPairs; ++k) pairs.push_back(oracle::randomPair(random, kind, kind));
    race(std::string(kind) + ", " + kind + ", hard", pairs, askedForTheGap());
  }
}

}  // namespace

/// beside_fcl_benchmark [gap | meets | hard]: one of the tables, or all. libccd takes minutes on the hard
/// pairs.
int main(int count, char** arguments) {
  const std::string table = count > 1 ? arguments[1] : "";
  if (table.empty() || table == "gap")
    std::printf("The gap and its direction:\n\n"), raceOrdinary(askedForTheGap);
  if (table.empty() || table == "meets")
    std::printf("\nWhether they meet:\n\n"), raceOrdinary(askedWhetherTheyMeet);
  if (table.empty() || table == "hard") std::printf("\nThe gap of hard pairs:\n\n"), raceHard();
}
