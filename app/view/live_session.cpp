// SPDX-License-Identifier: Apache-2.0
#include "app/view/live_session.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "sunder/error.hpp"

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

/// What is prepared.
std::string words_of(const InputAction& what) {
  if (const auto* open = std::get_if<input::Open>(&what)) return open->file;
  std::string words;
  for (const std::string& change : std::get<input::Set>(what).changes) {
    words += (words.empty() ? "" : ", ") + change;
  }
  return words;
}

}  // namespace

LiveSession::LiveSession(Session& session, Pace* pace)
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
      tasks_.push_back({std::move(what), {}, {}});
    }
  }
  wake_.notify_one();
}

void LiveSession::record(Receive receive) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back({std::nullopt, std::move(receive), {}});
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

void LiveSession::renew(std::string told) {
  {
    const std::lock_guard lock(mutex_);
    paused_.store(true);
    tasks_.push_front({std::nullopt, {}, std::move(told)});
  }
  wake_.notify_one();
}

LiveSession::Now LiveSession::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void LiveSession::perform(const Task& task) {
  if (task.receive) {
    task.receive(session_.hand().recording(), session_.origin());
    return;
  }
  if (!task.renewed.empty()) {
    session_.renew();
    throw DeviceLost(task.renewed);  // which is told as what goes wrong is
  }
  InputAction what = *task.what;
  if (!find_grip(what)) return;
  changes_body({0, what}) ? prepare(what) : take(what);
  for (const int grip : session_.hand().grips()) static_cast<void>(number_of(grip));
}

void LiveSession::take(const InputAction& what) {
  const Inputs inputs{"", {{0, what}}};
  session_.take(inputs, inputs.list.front());
}

/// Whoever draws is told meanwhile, and goes on with the frame of the body before.
void LiveSession::prepare(const InputAction& what) {
  {
    const std::lock_guard lock(mutex_);
    now_.preparing = words_of(what);
    now_.since = Clock::now();
  }
  struct Prepared {
    LiveSession& of;
    ~Prepared() {
      const std::lock_guard lock(of.mutex_);
      of.now_.preparing.clear();
    }
  } prepared{*this};
  take(what);
  forces_ = session_.simulation().grip_forces();
  std::map<int, int> numbers;
  for (const auto& [before, grip] : session_.carried()) numbers[grip] = number_of(before);
  numbers_ = std::move(numbers);
}

/// As told, of a grip of the simulation's.
int LiveSession::number_of(int grip) {
  const auto [at, fresh] = numbers_.try_emplace(grip, std::max(grip, next_number_));
  next_number_ = std::max(next_number_, at->second + 1);
  return at->second;
}

/// The other way round. False: the grip has not gone along with a change of the body.
bool LiveSession::find_grip(InputAction& what) {
  auto* const pose = std::get_if<input::Pose>(&what);
  auto* const release = std::get_if<input::Release>(&what);
  if (!pose && !release) return true;
  int& grip = pose ? pose->grip : release->grip;
  for (const auto& [of_simulation, told] : numbers_) {
    if (told != grip) continue;
    grip = of_simulation;
    return true;
  }
  return session_.body() == 0;  // the simulation says that there is none
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
    if (step && pace_) {
      due_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(pace_(session_.problem()));
    }
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
    grips.push_back(
        {number_of(grip), grip, simulation.centre_of(grip), {nodes.begin(), nodes.end()}});
  }
  const std::lock_guard lock(mutex_);
  now_.shown = std::move(shown);
  now_.grips = std::move(grips);
  now_.values = std::move(values);
  now_.undos = simulation.undos();
  now_.redos = simulation.redos();
  now_.done = simulation.done();
  now_.ruptures = std::move(ruptures);
  now_.body = session_.body();
  now_.origin = session_.origin();
  now_.said = session_.said();
  now_.forces = forces_;
}

}  // namespace sunder::app
