// SPDX-License-Identifier: BSD-3-Clause
// The reference is Fidelity::Reference in 8 divisions. Its uncertainty u is the change by halving its step,
// or a third of the change by quartering it, whichever is larger. Errors proportional to the step, e0/8, e0/4
// and e0/2, give e0/8 for both. In a chaotic scene, which amplifies rounding, two of the three runs may agree
// by chance, but hardly all three. Let e be the deviation of a run from the reference. Its error lies between
// e - u and e + u. So e is the error to a tenth where u <= e/10, and e + u is an upper bound everywhere.
#include "accuracy/accuracy_window.h"

#include "base/cpu_time.h"

#include <algorithm>

namespace rbs {
namespace {

constexpr std::uint32_t kReferenceDivisions = 8;
constexpr std::size_t kReferenceRuns = 3;
/// An uncertainty below this fraction of the smallest body is rounding, which a chaotic scene amplifies.
constexpr double kChaos = 1e-6;

Setting referenceIn(std::uint32_t divisions) {
  Setting setting(Fidelity::Reference);
  setting.divisions = divisions;
  return setting;
}

// The larger of a, and of a fraction of b.
Difference larger(Difference a, double fraction, const Difference& b) {
  a.distance = std::max(a.distance, fraction * b.distance);
  a.angle = std::max(a.angle, fraction * b.angle);
  a.energy = std::max(a.energy, fraction * b.energy);
  return a;
}

ErrorRate rateOf(const Difference& difference, double seconds) {
  return {difference.distance / seconds, difference.angle / seconds, difference.energy / seconds};
}

ErrorRate operator+(const ErrorRate& a, const ErrorRate& b) {
  return {a.distance + b.distance, a.angle + b.angle, a.energy + b.energy};
}

ErrorRate operator*(double factor, const ErrorRate& a) {
  return {factor * a.distance, factor * a.angle, factor * a.energy};
}

ErrorRate larger(const ErrorRate& a, const ErrorRate& b) {
  return {std::max(a.distance, b.distance), std::max(a.angle, b.angle), std::max(a.energy, b.energy)};
}

}  // namespace

AccuracyWindow::AccuracyWindow(const World& begin, const std::vector<SettingCost>& settings, double smallest)
    : smallest_(smallest) {
  const auto add = [&](const Setting& setting) {
    runs_.push_back({begin, 0.0});
    runs_.back().world.setFidelity(setting);
  };
  for (const SettingCost& cost : settings) add(cost.setting);
  add(referenceIn(kReferenceDivisions / 4));
  add(referenceIn(kReferenceDivisions / 2));
  add(referenceIn(kReferenceDivisions));
}

WindowReading AccuracyWindow::growTo(std::uint32_t steps, const std::function<void(World&)>& step) {
  for (Run& run : runs_) {
    const double start = threadCpuSeconds();
    for (std::uint32_t k = steps_; k < steps; ++k) step(run.world);
    run.seconds += threadCpuSeconds() - start;
  }
  steps_ = steps;

  WindowReading reading;
  reading.steps = steps;
  const Snapshot reference = runs_.back().world.snapshot();
  const std::size_t settings = runs_.size() - kReferenceRuns;
  reading.uncertainty = larger(differenceOf(runs_[settings + 1].world.snapshot(), reference), 1.0 / 3.0,
                               differenceOf(runs_[settings].world.snapshot(), reference));
  double largest = 0.0;
  for (std::size_t k = 0; k < settings; ++k) {
    reading.errors.push_back(differenceOf(runs_[k].world.snapshot(), reference));
    largest = std::max(largest, reading.errors.back().distance);
  }
  reading.converged =
      reading.uncertainty.distance <= std::max(kLargestUncertainty * largest, kChaos * smallest_);
  return reading;
}

double AccuracyWindow::seconds() const {
  double sum = 0.0;
  for (const Run& run : runs_) sum += run.seconds;
  return sum;
}

void WindowSum::add(const WindowReading& reading, double step) {
  const double seconds = reading.steps * step;
  const ErrorRate uncertainty = rateOf(reading.uncertainty, seconds);
  seconds_ += seconds;
  uncertainty_ = uncertainty_ + seconds * uncertainty;
  settings_.resize(reading.errors.size());
  for (std::size_t k = 0; k < settings_.size(); ++k) {
    Sum& sum = settings_[k];
    const ErrorRate error = rateOf(reading.errors[k], seconds);
    sum.error = sum.error + seconds * error;
    sum.worst = larger(sum.worst, error);
    sum.worst_bound = larger(sum.worst_bound, error + uncertainty);
  }
}

void WindowSum::write(AccuracyStudy& study) const {
  study.uncertainty = 1.0 / seconds_ * uncertainty_;
  for (std::size_t k = 0; k < settings_.size(); ++k) {
    SettingCost& cost = study.settings[k];
    const Sum& sum = settings_[k];
    cost.error = 1.0 / seconds_ * sum.error;
    cost.worst = sum.worst;
    const auto bound = [&](double ErrorRate::*part) {
      const bool unknown = study.uncertainty.*part >= kLargestUncertainty * cost.error.*part;
      if (unknown) cost.error.*part += study.uncertainty.*part, cost.worst.*part = sum.worst_bound.*part;
      return unknown;
    };
    cost.at_most = bound(&ErrorRate::distance);
    bound(&ErrorRate::angle);
    bound(&ErrorRate::energy);
  }
}

}  // namespace rbs
