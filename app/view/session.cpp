// SPDX-License-Identifier: Apache-2.0
#include "app/view/session.hpp"

#include <chrono>
#include <cmath>
#include <utility>

#include "app/output/text.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

std::string seconds_since(std::chrono::steady_clock::time_point start) {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  return rounded(passed.count(), 2) + " s";
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

Session::Session(const std::shared_ptr<const Problem>& problem, const Simulation::MakeBackend& make,
                 bool goes_back, const PictureSize& size,
                 std::shared_ptr<view::SharedPoints> points)
    : goes_back_(goes_back),
      body_(std::make_unique<Body>(problem, make, goes_back, std::move(points))),
      size_(size) {
  look_.camera = standard_camera(problem->mesh());
}

void Session::can_change(Origin origin, PlanBody plan) {
  origin_ = std::move(origin);
  plan_ = std::move(plan);
}

Camera Session::camera() const { return {look_.camera, look_.at, body_->points, size_}; }

void Session::advance() {
  if (!paused_) step();
}

void Session::renew() {
  if (problem().scene().solver.backend == "vulkan") simulation().renew_backend();
}

void Session::go_back(const Inputs& inputs, const Input& input) {
  try {
    if (const auto* undo = std::get_if<input::Undo>(&input.what)) hand().undo(undo->count);
    if (const auto* redo = std::get_if<input::Redo>(&input.what)) hand().redo(redo->count);
    if (std::holds_alternative<input::Reset>(input.what)) hand().reset();
    if (const auto* stroke = std::get_if<input::Stroke>(&input.what)) {
      hand().cut(cut_along(*stroke, camera()));
    }
  } catch (const UsageError& error) {
    throw InputError(InputFault::out_of_range, inputs.at(input) + error.what());
  }
}

void Session::take(const Inputs& inputs, const Input& given) {
  Input input = given;
  if (number_ > 0) resolve(inputs, input, problem());
  if (set(look_, input) || do_to_body(hand(), inputs, input)) return;
  if (const auto* pause = std::get_if<input::Pause>(&input.what)) {
    paused_ = pause->on;
  } else if (const auto* steps = std::get_if<input::Step>(&input.what)) {
    for (int i = 0; i < steps->count && !simulation().done(); ++i) step();
  } else if (changes_body(input)) {
    try {
      if (const auto* set = std::get_if<input::Set>(&input.what)) change(set->changes);
      if (const auto* other = std::get_if<input::Open>(&input.what)) open(other->file);
    } catch (const InputError& error) {
      throw InputError(error.fault(), inputs.at(input) + error.what());
    } catch (const UsageError& error) {
      throw InputError(InputFault::out_of_range, inputs.at(input) + error.what());
    }
  } else {
    go_back(inputs, input);
  }
}

std::unique_ptr<Body> Session::prepared(const Origin& origin) const {
  if (!plan_) throw UsageError("this body cannot be changed: it is of no file");
  const BodyPlan plan = plan_(origin);
  return std::make_unique<Body>(plan.problem, plan.make, goes_back_, plan.points);
}

void Session::take_on(std::unique_ptr<Body> body, Origin origin) {
  body_ = std::move(body);
  origin_ = std::move(origin);
  ++number_;
}

void Session::change(const std::vector<std::string>& changes) {
  const auto start = std::chrono::steady_clock::now();
  Origin next{origin_.file, changed(origin_.changes, changes)};
  std::unique_ptr<Body> body = prepared(next);
  const Carried carried = carry_over(*body_, *body);
  const bool same = same_base(*body_, *body);
  take_on(std::move(body), std::move(next));
  carried_ = carried.grips;
  if (look_.colour) {
    Input colour{0, *look_.colour};
    try {
      resolve({}, colour, problem());
    } catch (const InputError&) {
      look_.colour.reset();  // the scene no longer computes it
    }
  }
  said_.clear();
  for (const std::string& change : changes) said_ += (said_.empty() ? "" : ", ") + change;
  said_ += same ? ": by the base that was there" : ": by a new base";
  said_ += ", in " + seconds_since(start);
  if (const std::string words = carried.sentence(); !words.empty()) said_ += "; " + words;
}

void Session::open(const std::string& file) {
  const auto start = std::chrono::steady_clock::now();
  Origin next{file, {}};
  take_on(prepared(next), next);
  carried_.clear();
  look_.camera = standard_camera(problem().mesh());
  look_.at.reset();
  look_.colour.reset();
  look_.clip = {};
  said_ = "opened " + file + " in " + seconds_since(start);
}

std::shared_ptr<const Shown> Session::show(std::uint64_t since) {
  const std::shared_ptr<Shown> shown = body_->showing.show(since);
  shown->words = words();
  if (const StepReport* now = report()) shown->report = *now;
  return shown;
}

FrameWords Session::words() const {
  const Scene& scene = problem().scene();
  FrameWords words;
  words.title = scene.title;
  int destroyed = 0;
  for (const DestroyedElement& row : simulation().destroyed()) destroyed += row.lives ? 0 : 1;
  const StepReport* now = report();
  std::string line =
      "step " + std::to_string(simulation().steps_done()) + " of " + std::to_string(scene.steps);
  if (now) line += ", load " + rounded(now->load_factor, 3);
  line += ", " + counted(destroyed, "element") + " destroyed";
  if (const auto& rows = simulation().destroyed(); !rows.empty()) {
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
