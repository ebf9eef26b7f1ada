// SPDX-License-Identifier: Apache-2.0
#include "app/view/session.hpp"

#include <cmath>
#include <utility>

#include "app/output/text.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

/// A history is kept from before anything is done.
Simulation& with_history(Simulation& simulation, Simulation::MakeBackend make, bool goes_back) {
  if (goes_back) simulation.keep_history(std::move(make));
  return simulation;
}

std::string percent(double share) { return rounded(100 * share, 3) + " %"; }

}  // namespace

std::string sentence_of(const DestroyedElement& row) {
  std::string words = row.element == kNone ? "crack " + std::to_string(row.crack) + " has grown"
                      : row.lives          ? "crack " + std::to_string(row.crack) + " is born"
                                           : "element " + std::to_string(row.element) + " is gone";
  words += std::string(" (") + to_string(row.cause);
  if (row.ratio) words += ", ratio " + rounded(*row.ratio, 3);
  return words + ")";
}

Session::Session(std::shared_ptr<const Problem> problem, Simulation::MakeBackend make,
                 bool goes_back, const PictureSize& size)
    : simulation_(problem, make()),
      hand_(with_history(simulation_, make, goes_back), goes_back),
      shown_(shown_points(*problem)),
      size_(size),
      showing_(simulation_) {
  look_.camera = standard_camera(problem->mesh());
}

Camera Session::camera() const { return {look_.camera, look_.at, shown_, size_}; }

const StepReport* Session::report() const {
  const auto done = static_cast<std::size_t>(simulation_.steps_done());
  return done > 0 && done <= reports_.size() ? &reports_[done - 1] : nullptr;
}

void Session::step() {
  if (simulation_.done()) return;
  const auto number = static_cast<std::size_t>(simulation_.steps_done());
  const StepReport report = hand_.step();
  reports_.resize(number);
  reports_.push_back(report);
}

void Session::advance() {
  if (!paused_) step();
}

void Session::go_back(const Inputs& inputs, const Input& input) {
  try {
    if (const auto* undo = std::get_if<input::Undo>(&input.what)) hand_.undo(undo->count);
    if (const auto* redo = std::get_if<input::Redo>(&input.what)) hand_.redo(redo->count);
    if (std::holds_alternative<input::Reset>(input.what)) hand_.reset();
    if (const auto* stroke = std::get_if<input::Stroke>(&input.what)) {
      hand_.cut(cut_along(*stroke, camera()));
    }
  } catch (const UsageError& error) {
    throw InputError(InputFault::out_of_range, inputs.at(input) + error.what());
  }
}

void Session::take(const Inputs& inputs, const Input& input) {
  if (set(look_, input) || do_to_body(hand_, inputs, input)) return;
  if (const auto* pause = std::get_if<input::Pause>(&input.what)) {
    paused_ = pause->on;
  } else if (const auto* steps = std::get_if<input::Step>(&input.what)) {
    for (int i = 0; i < steps->count && !simulation_.done(); ++i) step();
  } else {
    go_back(inputs, input);
  }
}

std::shared_ptr<const Shown> Session::show(std::uint64_t since) {
  const std::shared_ptr<Shown> shown = showing_.show(since);
  shown->words = words();
  if (const StepReport* now = report()) shown->report = *now;
  return shown;
}

FrameWords Session::words() const {
  const Scene& scene = problem().scene();
  FrameWords words;
  words.title = scene.title;
  int destroyed = 0;
  for (const DestroyedElement& row : simulation_.destroyed()) destroyed += row.lives ? 0 : 1;
  const StepReport* now = report();
  std::string line =
      "step " + std::to_string(simulation_.steps_done()) + " of " + std::to_string(scene.steps);
  if (now) line += ", load " + rounded(now->load_factor, 3);
  line += ", " + counted(destroyed, "element") + " destroyed";
  if (const auto& rows = simulation_.destroyed(); !rows.empty()) {
    line += "; last: " + sentence_of(rows.back());
  }
  words.lines.push_back(std::move(line));
  if (!now) return words;
  line = "error " + rounded(now->error, 2);
  if (const auto& d = now->deformation) {
    line += ", strain " + percent(d->strain) + ", rotation " + rounded(d->rotation_deg, 3) + " deg";
    const bool beyond = std::abs(d->strain) > kSmallStrain || d->rotation_deg > kSmallRotationDeg;
    if (beyond && !problem().finite()) line += ": beyond what law linear is for";
  }
  words.lines.push_back(std::move(line));
  return words;
}

}  // namespace sunder::app
