// SPDX-License-Identifier: Apache-2.0
// The deferred update over a base that is made anew, beside the frames, once the damage has
// gathered many columns.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>

#include "solver/background_rebase.hpp"

namespace sunder::solver {

/// When a base is made anew.
struct Renewal {
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();
  std::size_t columns = kNever;        ///< of the damage, over a later base
  std::size_t first_columns = kNever;  ///< over the first one
  int events = 0;                      ///< from its start to the event that finds it in place
  std::chrono::milliseconds rest{0};   ///< of the thread that makes it (background_rebase.hpp)
  /// 0: that thread follows the events since. Otherwise that event finds the base made alone, and
  /// catch_up() follows so many at each event, until it puts it in place; there is then no way back
  /// to a state before.
  int events_at_once = 0;
};

class RenewedUpdate {
 public:
  /// A base of the body with no damage over it yet; `work` is for a factor on the way.
  using Make = std::function<Based(const fem::DamagedBody&, const linear_algebra::FactorWork&)>;

  /// Nothing will be destroyed.
  RenewedUpdate(const fem::DamagedBody& body, Based first);
  /// The body must outlive it.
  RenewedUpdate(const fem::DamagedBody& body, Based first, const Renewal& renewal, Make make);

  /// Remembers the load of a frame: a base that is made is checked by it.
  void loaded(const Load& load) { load_ = load; }
  /// Follows an event that the body has recorded already. `anew`: a base of the body as it is now
  /// costs less than following. Throws NumericalError where a new base is needed and cannot be.
  void follow(const fem::Event& event, bool anew = false);
  /// Waits for a base of the body as it is now. False: nothing can be destroyed, or new nodes are
  /// there that no base takes over (parted_body.hpp).
  bool rebase();

  /// What of a state bases and what is laid over them go back to.
  struct State {
    Based based;  // held on to: its memory with it
    std::optional<fem::PartedBody::State> parted;
    int bases = 1;
    std::size_t threshold = 0;
    Index laid = 0;  // events over the base
    bool making = false;
    std::size_t start = 0;  // events before the base that is being made
    Load load;              // by which that is checked
    Load loaded;
  };
  [[nodiscard]] State state() const;
  /// The body still records later events than the first `events`. Waits for nothing: what makes
  /// a base may go on for a while.
  void stop(std::size_t events);
  void go_back(const State& state);

  /// Throws NumericalError after an event for which no base could be made.
  [[nodiscard]] Deferred& deferred() { return based_.laid_over(); }
  [[nodiscard]] const Deferred& deferred() const { return based_.laid_over(); }
  /// The body in whose terms deferred() is; null: in those of the body itself.
  [[nodiscard]] const fem::PartedBody* parted() const { return based_.parted.get(); }
  /// The factor of the damaged body below; null: the base is the first.
  [[nodiscard]] const linear_algebra::Factor* factor() const { return based_.factor.get(); }
  [[nodiscard]] int bases() const { return bases_; }
  /// Events of the body that the present base holds, and those that the one that is being made
  /// will hold.
  [[nodiscard]] std::size_t base_events() const {
    return body_.events() - static_cast<std::size_t>(deferred().events());
  }
  [[nodiscard]] std::optional<std::size_t> coming_events() const {
    const bool comes = coming_ && (coming_->making() || made_);
    return comes ? std::optional(start_events_) : std::nullopt;
  }
  /// A base that is made and lacks events (Renewal::events_at_once); null: there is none.
  [[nodiscard]] Deferred* made() const { return made_ ? made_->deferred.get() : nullptr; }
  /// While held no base begins.
  void hold(bool held) { held_ = held; }
  /// Follows some of these, and puts it in place once it lacks none. After follow().
  void catch_up();
  [[nodiscard]] const BaseCheck& base_check() const { return based_.check; }
  /// All after the first one so far.
  [[nodiscard]] NewBases new_bases() const {
    NewBases all = new_bases_;
    if (coming_) all.waited_ms += coming_->waited_ms();
    return all;
  }
  [[nodiscard]] double saved_ms() const {
    return saved_ms_ + (based_.deferred ? based_.deferred->saved_ms() : 0);
  }

 private:
  void take_made();
  [[nodiscard]] bool follow_made();
  [[nodiscard]] bool can_be_renewed() const;
  [[nodiscard]] bool begins() const;
  [[nodiscard]] Based make_checked(const fem::DamagedBody& body, const Load& load,
                                   const linear_algebra::FactorWork& work) const;
  void take_base();
  void renewed();

  const fem::DamagedBody& body_;
  Load load_;
  [[nodiscard]] MakeBase checked() const;
  Load start_load_;               // of the base that is being made
  std::size_t start_events_ = 0;  // before it
  Based based_;
  bool held_ = false;
  std::optional<Based> made_;
  std::size_t made_events_ = 0;  // that it holds
  fem::Change event_;            // of them
  Renewal renewal_;
  Make make_;
  std::size_t threshold_ = 0;  // columns at which a new base begins
  int bases_ = 1;
  NewBases new_bases_;
  double saved_ms_ = 0;                     // by the bases before this one
  std::optional<BackgroundRebase> coming_;  // last: its thread uses what is above
};

}  // namespace sunder::solver
