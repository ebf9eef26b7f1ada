// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/judgement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/output/text.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kOnePiece = 0.9, kMostlyGrowth = 0.5;
constexpr double kAtTip = 3.0;  // h: within the band that the criterion itself looks at, twice
constexpr double kMostSnapshots = 0.75, kHalf = 0.5;
constexpr double kFewShared = 0.5, kManyShared = 0.8;
constexpr double kTurn = 5.0;      // deg: a deviation the eye sees on the paper's pictures
constexpr double kDip = 0.1;       // of the height: not a turn of its own
constexpr double kResolved = 1.0;  // h: a smaller deviation is the mesh's
constexpr double kClearly = 0.05;  // 5 %: of forces, lengths
constexpr double kAlike = 1.25;    // times: equal but for what a machine does meanwhile
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

Judgement judge_peak_at_tip(std::span<const std::optional<double>> distances,
                            const std::string& at) {
  Judgement judgement;
  double near = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    near += known(distances[i]) <= kAtTip ? 1 : 0;
    judgement.numbers.push_back(
        {"distance of the peak from " + at + ", picture " + std::to_string(i + 1) + " [h]",
         distances[i]});
  }
  const double share = distances.empty() ? 0 : near / static_cast<double>(distances.size());
  judgement.verdict = verdict_of(share >= kMostSnapshots, share >= kHalf);
  judgement.rule = "reproduced: within " + rounded(kAtTip, 2) + " h of " + at + " in at least " +
                   percent(kMostSnapshots) + " of the pictures; partly: in at least half";
  return judgement;
}

Judgement judge_models_differ(std::optional<double> overlap) {
  return {verdict_of(known(overlap) <= kFewShared, known(overlap) <= kManyShared),
          "reproduced: at most " + percent(kFewShared) + " of all elements are in both lists; " +
              "partly: at most " + percent(kManyShared),
          {{"share of elements in both lists", overlap}}};
}

namespace {

bool goes_up(const Turns& turns) {
  return turns.rise_deg >= kTurn && -turns.dip <= kDip * turns.highest;
}

}  // namespace

bool goes_up_then_down(const Turns& turns) { return goes_up(turns) && turns.fall_deg <= -kTurn; }

Judgement judge_up_then_down(const std::optional<Turns>& turns, double h) {
  const bool up = turns && goes_up(*turns), down = turns && goes_up_then_down(*turns);
  const bool resolved = turns && turns->highest >= kResolved * h;
  Judgement judgement{verdict_of(down && resolved, up),
                      "reproduced: mean slope at least " + rounded(kTurn, 2) +
                          " deg up to the highest point, which is at least " +
                          rounded(kResolved, 2) +
                          " h above the begin, before it never lower than " + percent(kDip) +
                          " of that height below the begin, and at least " + rounded(kTurn, 2) +
                          " deg down from there; partly: a lower top, or up only",
                      {}};
  const auto number = [&](double Turns::*which) {
    return turns ? std::optional<double>((*turns).*which) : std::nullopt;
  };
  judgement.numbers = {
      {"slope to the highest point [deg]", number(&Turns::rise_deg)},
      {"slope from there [deg]", number(&Turns::fall_deg)},
      {"highest point [mm]", number(&Turns::highest)},
      {"highest point [h]", turns ? std::optional<double>(turns->highest / h) : std::nullopt},
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

Judgement judge_goes_further(const NextRupture& near, const NextRupture& far) {
  const double ratio = known(near.length) / known(far.length);
  const bool only_near = known(near.length) > 0 && known(far.length) == 0;
  return {verdict_of(ratio >= 1 + kClearly || only_near, ratio > 1),
          "reproduced: under the same force the next rupture is longer by at least " +
              percent(kClearly) + "; partly: longer by less",
          {{"next rupture, pressed near the tip [mm]", near.length},
           {"next rupture, pressed far from it [mm]", far.length},
           {"reach of Eq. 1, near [mm]", near.reach},
           {"reach of Eq. 1, far [mm]", far.reach}}};
}

Judgement judge_final_length(std::span<const FinalLength> lengths) {
  bool rises = lengths.size() > 1, outruns = rises;
  Judgement judgement;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    judgement.numbers.push_back(
        {"final length from " + rounded(lengths[i].preset, 3) + " mm [mm]", lengths[i].final});
    if (i == 0) continue;
    const double more = known(lengths[i].final) - known(lengths[i - 1].final);
    rises = rises && more > 0;
    outruns = outruns && more > (1 + kClearly) * (lengths[i].preset - lengths[i - 1].preset);
  }
  judgement.verdict = verdict_of(rises && outruns, rises);
  judgement.rule =
      "reproduced: from each preset length to the next the final length rises by at least " +
      percent(kClearly) +
      " more than the preset length itself, so that a longer notch also tears further; partly: it "
      "rises, but at some step by no more than the notch";
  return judgement;
}

Judgement judge_propagation_first(const Order& order) {
  const bool kept = order.growths > 0 && order.mixed == 0;
  const bool tested = order.went_first > 0;
  return {verdict_of(kept && tested, kept),
          "reproduced: no event both grows a crack and starts one, and at least one growth went "
          "before an element, away from every crack, that stood at or above its yield stress; "
          "partly: none stood there, so that the order was not put to the test",
          {{"events by growth", order.growths},
           {"of them before an element at its yield stress", order.went_first},
           {"events that start a crack", order.births},
           {"events that do both", order.mixed}}};
}

Judgement judge_several(const Several& several) {
  const bool cracks = several.grown >= 2;
  return {verdict_of(cracks && several.tools >= 2 && several.at_once > 0, cracks),
          "reproduced: at least two cracks grow, at least two instruments are the nearest one to a "
          "crack, and at least once two cracks grow in one event; partly: at least two cracks grow",
          {{"cracks that grew", several.grown},
           {"instruments with a crack of their own", several.tools},
           {"events in which several cracks grow", several.at_once}}};
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

Judgement judge_equal_totals(std::span<const Figure> totals) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  bool complete = totals.size() > 1;
  for (const Figure& total : totals) {
    complete = complete && total.value.has_value();
    least = std::min(least, total.value.value_or(least));
    most = std::max(most, total.value.value_or(most));
  }
  const double ratio = complete ? most / least : std::nan("");
  Judgement judgement{verdict_of(ratio <= 1 + kClearly, ratio <= kAlike),
                      "reproduced: the longest at most " + percent(kClearly) +
                          " above the shortest (the paper: 3.6 %); partly: at most " +
                          percent(kAlike - 1),
                      {totals.begin(), totals.end()}};
  judgement.numbers.push_back(
      {"longest / shortest", std::isfinite(ratio) ? std::optional<double>(ratio) : std::nullopt});
  return judgement;
}

Judgement judge_takes_longer(std::optional<double> more, std::optional<double> less,
                             const std::string& first, const std::string& second) {
  const double ratio = known(more) / known(less);
  return {verdict_of(ratio >= 1 + kClearly, ratio > 1),
          "reproduced: longer by at least " + percent(kClearly) + "; partly: longer by less",
          {{first + " [ms]", more}, {second + " [ms]", less}}};
}

}  // namespace sunder::app::reproduce
