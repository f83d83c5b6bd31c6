// SPDX-License-Identifier: BSD-3-Clause
// rollout(): many worlds on threads of their own, their states in one array.
#include "values.h"
#include "world.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace rbs::python {
namespace {

/// What the runs fill: samples of a scene follow each other, and scenes too.
struct Results {
  std::size_t samples, bodies;
  double *states, *times;
  std::uint64_t* hashes;
  std::vector<std::set<std::string>> flags;  // of each scene

  /// A sample of a run. What it has no bodies for is NaN.
  void write(std::size_t run, std::size_t sample, const World& world) const {
    const std::size_t at = run * samples + sample;
    double* row = states + at * bodies * kStateLength;
    double* const end = row + bodies * kStateLength;
    for (const BodyState& state : world.states()) row = std::copy_n(rowOf(state), kStateLength, row);
    std::fill(row, end, std::numeric_limits<double>::quiet_NaN());
    times[at] = world.time();
  }
};

/// Runs the scenes on threads, each on the one that comes to it first. What a run does depends on its scene alone.
class Runs {
 public:
  Runs(std::vector<SceneFile> scenes, std::uint64_t steps, std::uint64_t every, Results& results)
      : scenes_(std::move(scenes)), steps_(steps), every_(every), results_(results) {}
  ~Runs() { stop(); }
  Runs(const Runs&) = delete;
  Runs& operator=(const Runs&) = delete;

  void start(std::size_t threads) {
    for (std::size_t k = 0; k < std::min(threads, scenes_.size()); ++k) {
      {
        const std::lock_guard lock(mutex_);
        ++working_;
      }
      try {
        threads_.emplace_back([this] { work(); });
      } catch (...) {
        leave();
        throw;
      }
    }
  }
  /// Returns whether all is done or has failed, after this time at the latest.
  bool wait(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return done_.wait_for(lock, time, [this] { return working_ == 0; });
  }
  /// Ends the runs between two steps.
  void stop() {
    stopping_ = true;
    for (std::thread& thread : threads_)
      if (thread.joinable()) thread.join();
  }
  /// Throws the error of the first scene that had one, once all is done.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void work() {
    while (!stopping_) {
      const std::size_t run = next_++;
      if (run >= scenes_.size()) break;
      try {
        this->run(run);
      } catch (const InvalidInput& error) {
        fail(run, std::make_exception_ptr(InvalidInput(placed(error, run))));
      } catch (...) {
        fail(run, std::current_exception());
      }
    }
    leave();
  }
  void run(std::size_t run) {
    SceneFile& file = scenes_[run];
    World world(std::move(file.scene), file.state);
    results_.write(run, 0, world);
    for (std::uint64_t step = 1; step <= steps_ && !stopping_; ++step) {
      for (const Warning& warning : world.step().warnings) results_.flags[run].insert(warning.kind);
      if (step % every_ == 0) results_.write(run, step / every_, world);
    }
    results_.hashes[run] = world.stateHash();
  }
  static std::vector<Problem> placed(const InvalidInput& error, std::size_t run) {
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) problem.path = "scenes[" + std::to_string(run) + "]." + problem.path;
    return problems;
  }
  /// Scenes are taken in order, and each that is taken is checked, also when runs are to end. So the first faulty one is
  /// always found.
  void fail(std::size_t run, std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (!error_ || run < failed_) failed_ = run, error_ = std::move(error);
    stopping_ = true;
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    if (--working_ == 0) done_.notify_all();
  }

  std::vector<SceneFile> scenes_;
  const std::uint64_t steps_, every_;
  Results& results_;
  std::vector<std::thread> threads_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stopping_{false};
  std::mutex mutex_;
  std::condition_variable done_;
  std::size_t working_ = 0, failed_ = 0;  // under the mutex, like the error
  std::exception_ptr error_;
};

std::vector<SceneFile> toScenes(py::handle scenes) {
  if (!py::isinstance<py::iterable>(scenes)) refuse("scenes", textOf(scenes), "a list of Scene");
  std::vector<SceneFile> files;
  for (const py::handle scene : scenes) {
    const std::string path = "scenes[" + std::to_string(files.size()) + "]";
    if (!py::isinstance<Scene>(scene)) refuse(path, textOf(scene), "a Scene");
    files.push_back(scene.cast<const Scene&>().file());
  }
  if (files.empty()) refuse("scenes", "none", "one or more");
  return files;
}

/// Starts the runs and waits for them without the lock of the interpreter. A signal, such as Ctrl-C, ends them.
void waitFor(Runs& runs, std::size_t threads) {
  constexpr std::chrono::milliseconds kBetweenSignals{50};
  const py::gil_scoped_release release;
  runs.start(threads);
  while (!runs.wait(kBetweenSignals)) {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

py::object rollout(py::handle scenes, py::handle steps, py::handle every, py::handle threads) {
  const std::uint64_t n = toWhole(steps, "steps", 1, 1'000'000'000), stride = toWhole(every, "every", 1, n),
                      most = toWhole(threads, "threads", 1, 256);
  if (n % stride != 0) refuse("every", std::to_string(stride), "a divisor of steps, " + std::to_string(n));
  std::vector<SceneFile> files = toScenes(scenes);
  const std::size_t count = files.size(), samples = n / stride + 1;
  std::size_t bodies = 0;
  for (const SceneFile& file : files) bodies = std::max(bodies, file.scene.bodies.size());
  py::array_t<double> states({count, samples, bodies, std::size_t{kStateLength}}), times({count, samples});
  py::array_t<std::uint64_t> hashes(static_cast<py::ssize_t>(count));
  Results results{samples, bodies, states.mutable_data(), times.mutable_data(), hashes.mutable_data(), {}};
  results.flags.resize(count);

  Runs runs(std::move(files), n, stride, results);
  waitFor(runs, most);
  runs.rethrow();
  py::tuple flags(count);
  for (std::size_t run = 0; run < count; ++run) {
    py::list kinds;
    for (const std::string& kind : results.flags[run]) kinds.append(kind);
    flags[run] = py::tuple(kinds);
  }
  return typeNamed("Rollout")(states, times, hashes, flags);
}

}  // namespace

void bindRollout(py::module_& module) {
  module.def(
      "rollout", &rollout, py::arg("scenes"), py::arg("steps"), py::arg("every") = 1, py::arg("threads") = 1,
      Doc("Runs many scenes on threads, without the lock of the interpreter, and returns a Rollout: (states, "
          "times, hashes, flags).\n\nscenes: Scene objects, one or more, each a run of its own. steps: of "
          "each run, "
          "1 or more. every: a sample every so many steps,\na divisor of steps; the first sample is before "
          "the first step, so there are steps / every + 1 of them.\nthreads: 1 to 256; results are equal for "
          "every number, bit for bit.\n\nstates is (scenes, samples, bodies, 13): position (m), orientation "
          "[x, y, z, w], velocity (m/s), angular velocity\n(rad/s), in W, of each body in the order of its "
          "scene; NaN where a scene has fewer bodies than another. times is\n(scenes, samples), s. hashes is "
          "(scenes,), World.state_hash() at the end. flags has a tuple for each scene: the kinds of warnings "
          "that its steps gave,\nsuch as 'non_finite' where a body was stopped; empty: none.\n\nRaises "
          "InvalidInput for a faulty scene, with its "
          "number: 'scenes[3].bodies[0].mass: ...'. Ctrl-C raises KeyboardInterrupt."));
}

}  // namespace rbs::python
