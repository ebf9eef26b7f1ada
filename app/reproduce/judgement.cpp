// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/judgement.hpp"

#include <cmath>

#include "app/output/text.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kOnePiece = 0.9, kMostlyGrowth = 0.5;
constexpr double kAtTip = 3.0;  // h: within the band that the criterion itself looks at, twice
constexpr double kMostSnapshots = 0.75, kHalf = 0.5;
constexpr double kFewShared = 0.5, kManyShared = 0.8;
constexpr double kTurn = 5.0;      // deg: a deviation the eye sees on the paper's pictures
constexpr double kDip = 0.1;       // of the height: not a turn of its own
constexpr double kClearly = 0.05;  // 5 %: of forces, lengths
constexpr double kAngleStep = 2.0, kStraight = 10.0;  // deg

/// Comparisons with NaN or a missing number are false.
double known(std::optional<double> value) { return value.value_or(std::nan("")); }

Verdict verdict_of(bool all, bool some) {
  return all ? Verdict::reproduced : some ? Verdict::partly : Verdict::no;
}

std::string percent(double share) { return rounded(100 * share, 3) + " %"; }

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::partly:
      return "partly";
    default:
      return "not reproduced";
  }
}

Judgement judge_one_crack(const OneCrack& measured) {
  const bool piece = known(measured.connected) >= kOnePiece;
  const bool growth = known(measured.growth) >= kMostlyGrowth;
  return {verdict_of(piece && growth, piece || growth),
          "reproduced: at least " + percent(kOnePiece) +
              " of the fractures hang together and at least " + percent(kMostlyGrowth) +
              " are growth of a crack; partly: one of the two",
          {{"share in the largest piece", measured.connected},
           {"share by growth of a crack", measured.growth}}};
}

Judgement judge_peak_at_tip(std::span<const std::optional<double>> distances) {
  Judgement judgement;
  double near = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    near += known(distances[i]) <= kAtTip ? 1 : 0;
    judgement.numbers.push_back(
        {"distance of the peak from the tip, picture " + std::to_string(i + 1) + " [h]",
         distances[i]});
  }
  const double share = distances.empty() ? 0 : near / static_cast<double>(distances.size());
  judgement.verdict = verdict_of(share >= kMostSnapshots, share >= kHalf);
  judgement.rule = "reproduced: within " + rounded(kAtTip, 2) + " h of a tip in at least " +
                   percent(kMostSnapshots) + " of the pictures; partly: in at least half";
  return judgement;
}

Judgement judge_models_differ(std::optional<double> overlap) {
  return {verdict_of(known(overlap) <= kFewShared, known(overlap) <= kManyShared),
          "reproduced: at most " + percent(kFewShared) + " of all elements are in both lists; " +
              "partly: at most " + percent(kManyShared),
          {{"share of elements in both lists", overlap}}};
}

Judgement judge_up_then_down(const std::optional<Turns>& turns) {
  const bool first = turns && -turns->dip <= kDip * turns->highest;
  const bool up = turns && turns->rise_deg >= kTurn && first;
  const bool down = up && turns->fall_deg <= -kTurn;
  Judgement judgement{verdict_of(up && down, up),
                      "reproduced: mean slope at least " + rounded(kTurn, 2) +
                          " deg up to the highest point, before it never lower than " +
                          percent(kDip) + " of that height below the begin, and at least " +
                          rounded(kTurn, 2) + " deg down from there; partly: up only",
                      {}};
  const auto number = [&](double Turns::*which) {
    return turns ? std::optional<double>((*turns).*which) : std::nullopt;
  };
  judgement.numbers = {{"slope to the highest point [deg]", number(&Turns::rise_deg)},
                       {"slope from there [deg]", number(&Turns::fall_deg)},
                       {"highest point [mm]", number(&Turns::highest)},
                       {"lowest before it [mm]", number(&Turns::dip)},
                       {"height at the end [mm]", number(&Turns::end)}};
  return judgement;
}

Judgement judge_lower_force(std::optional<double> lower, std::optional<double> higher,
                            const std::string& first, const std::string& second) {
  const double ratio = known(lower) / known(higher);
  return {verdict_of(ratio <= 1 - kClearly, ratio < 1),
          "reproduced: the critical force is lower by at least " + percent(kClearly) +
              "; partly: lower by less",
          {{first + " [N]", lower},
           {second + " [N]", higher},
           {"ratio", std::isfinite(ratio) ? std::optional<double>(ratio) : std::nullopt}}};
}

Judgement judge_goes_further(std::optional<double> near, std::optional<double> far) {
  const double ratio = known(near) / known(far);
  const bool only_near = known(near) > 0 && known(far) == 0;
  return {verdict_of(ratio >= 1 + kClearly || only_near, ratio > 1),
          "reproduced: longer by at least " + percent(kClearly) + "; partly: longer by less",
          {{"grown, pressed near the tip [mm]", near}, {"grown, pressed far from it [mm]", far}}};
}

Judgement judge_sides(const SideAngles& a) {
  const double upper = known(a.upper), balanced = known(a.balanced), under = known(a.under);
  const bool order = upper >= balanced + kAngleStep && balanced >= under + kAngleStep;
  const bool sides = upper > 0 && under < 0 && std::abs(balanced) <= kStraight;
  return {verdict_of(order && sides, order),
          "reproduced: upper above 0, balanced within " + rounded(kStraight, 3) +
              " deg of 0, under below 0, each " + rounded(kAngleStep, 2) +
              " deg apart; partly: the order alone",
          {{"first growth, upper face [deg]", a.upper},
           {"first growth, balanced [deg]", a.balanced},
           {"first growth, under face [deg]", a.under}}};
}

Judgement judge_side_forces(const SideForces& f) {
  const bool with = known(f.under) < known(f.none), against = known(f.none) < known(f.upper);
  return {verdict_of(with && against, with || against),
          "reproduced: the critical force falls with the expansion (under face) and rises against "
          "it (upper face); partly: one of the two",
          {{"critical force, under face [N]", f.under},
           {"critical force, no pressure [N]", f.none},
           {"critical force, upper face [N]", f.upper}}};
}

Judgement judge_takes_longer(std::optional<double> more, std::optional<double> less,
                             const std::string& first, const std::string& second) {
  const double ratio = known(more) / known(less);
  return {verdict_of(ratio >= 1 + kClearly, ratio > 1),
          "reproduced: longer by at least " + percent(kClearly) + "; partly: longer by less",
          {{first + " [ms]", more}, {second + " [ms]", less}}};
}

}  // namespace sunder::app::reproduce
