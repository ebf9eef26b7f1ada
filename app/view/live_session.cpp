// SPDX-License-Identifier: Apache-2.0
#include "app/view/live_session.hpp"

#include <exception>
#include <utility>

namespace sunder::app {
namespace {

constexpr std::size_t kRuptures = 5;  // that are told

bool same_instrument(const InputAction& a, const InputAction& b) {
  const auto* one = std::get_if<input::Drive>(&a);
  const auto* other = std::get_if<input::Drive>(&b);
  if (one && other) return one->index == other->index && !one->further && !other->further;
  const auto* posed = std::get_if<input::Pose>(&a);
  const auto* anew = std::get_if<input::Pose>(&b);
  if (posed && anew) return posed->grip == anew->grip;
  const auto* turned = std::get_if<input::Turn>(&a);
  const auto* again = std::get_if<input::Turn>(&b);
  return turned && again && turned->index == again->index;
}

}  // namespace

LiveSession::LiveSession(Session& session, std::chrono::duration<double> pace)
    : session_(session),
      pace_(pace),
      forces_(session.simulation().grip_forces()),
      due_(Clock::now()) {
  session_.pause(false);  // this one pauses
  publish();
  thread_ = std::thread([this] { run(); });
}

LiveSession::~LiveSession() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void LiveSession::post(InputAction what) {
  {
    const std::lock_guard lock(mutex_);
    if (!tasks_.empty() && tasks_.back().what && same_instrument(*tasks_.back().what, what)) {
      tasks_.back().what = std::move(what);
    } else {
      tasks_.push_back({std::move(what), {}});
    }
  }
  wake_.notify_one();
}

void LiveSession::record(std::function<void(const std::string&)> receive) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back({std::nullopt, std::move(receive)});
  }
  wake_.notify_one();
}

void LiveSession::pause(bool on) {
  {
    const std::lock_guard lock(mutex_);
    paused_.store(on);
    if (!on) now_.error.reset();
  }
  wake_.notify_one();
}

LiveSession::Now LiveSession::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void LiveSession::perform(const Task& task) {
  if (task.receive) {
    task.receive(session_.hand().recording());
    return;
  }
  const Inputs inputs{"", {{0, *task.what}}};
  session_.take(inputs, inputs.list.front());
}

/// What goes wrong pauses and is told; the body stays as it is.
void LiveSession::run() {
  for (;;) {
    std::deque<Task> tasks;
    bool step = false;
    {
      std::unique_lock lock(mutex_);
      const auto goes_on = [this] { return !paused_.load() && !now_.done; };
      wake_.wait(lock, [&] { return over_ || !tasks_.empty() || goes_on(); });
      // What is to be done is not kept waiting for the next step.
      if (tasks_.empty()) {
        wake_.wait_until(lock, due_, [&] { return over_ || !tasks_.empty() || !goes_on(); });
      }
      if (over_) return;
      tasks.swap(tasks_);
      step = goes_on() && Clock::now() >= due_;
    }
    if (step) due_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(pace_);
    std::optional<std::string> error;
    const auto attempt = [&](const auto& what) {
      try {
        what();
      } catch (const std::exception& wrong) {
        if (!error) error = wrong.what();
      }
    };
    // What cannot be done takes nothing of what comes after it along.
    for (const Task& task : tasks) attempt([&] { perform(task); });
    if (step && !error) attempt([&] { session_.step(); });
    const bool anything = step || !tasks.empty();
    if (anything) attempt([&] { publish(); });
    if (error) paused_.store(true);
    if (!anything) continue;
    const std::lock_guard lock(mutex_);
    if (error || !tasks.empty()) now_.error = std::move(error);
  }
}

void LiveSession::publish() {
  Simulation& simulation = session_.simulation();
  std::shared_ptr<const Shown> shown = session_.show(drawn_.load());
  std::vector<Vec3> values;
  for (std::size_t i = 0; i < session_.problem().scene().instruments.size(); ++i) {
    values.push_back(session_.hand().value(i));
  }
  const auto& rows = simulation.destroyed();
  std::vector<std::string> ruptures;
  for (std::size_t i = rows.size() > kRuptures ? rows.size() - kRuptures : 0; i < rows.size();
       ++i) {
    ruptures.push_back(sentence_of(rows[i]));
  }
  std::vector<HeldNodes> grips;
  for (const int grip : session_.hand().grips()) {
    const auto nodes = simulation.held_nodes(grip);
    grips.push_back({grip, simulation.centre_of(grip), {nodes.begin(), nodes.end()}});
  }
  const std::lock_guard lock(mutex_);
  now_.shown = std::move(shown);
  now_.grips = std::move(grips);
  now_.values = std::move(values);
  now_.undos = simulation.undos();
  now_.redos = simulation.redos();
  now_.done = simulation.done();
  now_.ruptures = std::move(ruptures);
}

}  // namespace sunder::app
