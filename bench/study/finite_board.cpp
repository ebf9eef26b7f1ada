// SPDX-License-Identifier: Apache-2.0
#include "bench/study/finite_board.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "support/sequences.hpp"
#include "support/sliver.hpp"
#include "support/structured_board.hpp"

namespace sunder::bench {
namespace {

constexpr double kSide = kFiniteSide;

/// Fibres of the study's in one material.
std::vector<Fibres> fibres_of(const FibreDifficulty& difficulty, const Material& material) {
  std::vector<Fibres> all;
  for (int i = 0; i < difficulty.families; ++i) {
    Fibres of;
    of.direction = Vec3(i == 0 ? 1 : -1, 1, 0);
    if (material.law == MaterialLaw::linear) {
      of.young_along = difficulty.k1;
      of.poisson_along = 0.1;  // far from where a deformation would set energy free
      of.shear_along = difficulty.k1 / 5;
    } else {
      of.k1 = difficulty.k1;
      of.k2 = difficulty.k2;
      of.dispersion = difficulty.dispersion;
    }
    all.push_back(of);
  }
  return all;
}

/// Both hands turned about the board's middle as one.
Hands turned_as_one(double degrees) {
  const Vec3 axis = Vec3(1, 2, -2) / 3;
  const Mat3 r = Eigen::AngleAxisd(degrees / 180 * std::numbers::pi, axis).toRotationMatrix();
  const Vec3 arm(0, kSide / 2, 0);
  Hands hands;
  hands.lower_turn = hands.upper_turn = degrees * axis;
  hands.upper = r * arm - arm;
  hands.lower = -hands.upper;
  return hands;
}

/// The layer across the middle goes from one side to the other in thirds, the last column stays.
void part(const Problem& problem, const std::function<void(double)>& stretch,
          std::vector<Step>& steps) {
  std::vector<Index> layer;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (problem.in_interface(e)) layer.push_back(e);
  }
  std::ranges::stable_sort(layer, {},
                           [&](Index e) { return test::centroid(problem.mesh(), e).x(); });
  stretch(.05);
  stretch(.1);
  const std::size_t third = layer.size() / 3, last = layer.size() / 6;
  for (std::size_t begin = 0; begin + last < layer.size(); begin += third) {
    const std::size_t end = std::min(begin + third, layer.size() - last);
    stretch(.1);
    steps.back().destroyed.assign(layer.begin() + static_cast<long>(begin),
                                  layer.begin() + static_cast<long>(end));
  }
  stretch(.2);
}

}  // namespace

Scene finite_scene(const FiniteCell& cell, const SolverOptions& solver) {
  Scene scene;
  scene.title = "board of the stability study at finite deformation";
  scene.solver = solver;
  scene.mesh = test::structured_board({6, 6, 1, kSide, kSide, kFiniteDepth}, [](const Vec3& x) {
    return x.y() > 41 || x.y() < 9 ? "frame" : x.y() > 25 ? "upper" : "lower";
  });
  if (cell.sliver < 1) test::make_sliver(scene.mesh, Vec3(25, 33, 2.5), 9, cell.sliver);
  scene.materials = {{"upper", {5, cell.poisson, 2.0, cell.law}},
                     {"lower", {8, cell.poisson, 4.0, cell.law}},
                     {"frame", {5 * cell.contrast, cell.poisson, std::nullopt, cell.law}}};
  for (auto& [name, material] : scene.materials) {
    if (cell.pooled) material.volume = MaterialVolume::pooled;
    if (cell.fibres && name != "frame") material.fibres = fibres_of(*cell.fibres, material);
  }
  if (cell.interface) {
    scene.interfaces.push_back(
        {{"lower", "upper"}, cell.interface->strength, cell.interface->energy, 1});
  }
  for (const double y : {0.0, kSide}) {
    Instrument hand;
    hand.name = y == 0 ? "lower" : "upper";
    hand.action = Grip{Box{Vec3(-1, y - .01, -1), Vec3(51, y + .01, 6)}, Vec3(0, 0, 0), Axes{7},
                       true, Vec3(0, 0, 0)};
    scene.instruments.push_back(hand);
  }
  return scene;
}

std::vector<Step> steps_of(const std::string& motion, const Problem& problem) {
  std::vector<Step> steps;
  const auto lower_to = [&](double amount, const Vec3& at, const Vec3& turn = Vec3::Zero()) {
    Hands hands;
    hands.lower = at;
    hands.lower_turn = turn;
    steps.push_back({amount, hands, {}});
  };
  const auto stretch = [&](double strain) { lower_to(strain, Vec3(0, -strain * kSide, 0)); };
  if (motion == "stretch") {
    for (double strain : {.1, .2, .4, .6, .8, 1.0}) stretch(strain);
  } else if (motion == "turn") {
    for (double degrees = 30; degrees <= 180; degrees += 30)
      steps.push_back({degrees, turned_as_one(degrees), {}, true});
  } else if (motion == "twist") {
    for (double degrees = 30; degrees <= 180; degrees += 30)
      lower_to(degrees, Vec3(0, 0, 0), Vec3(0, degrees, 0));
  } else if (motion == "fold") {
    // About the board's own width: the lower edge comes over to the other side.
    for (double degrees = 30; degrees <= 180; degrees += 30) {
      const double a = degrees / 180 * std::numbers::pi;
      const double radius = kSide / 2;
      lower_to(degrees, Vec3(0, radius * (1 - std::cos(a)), radius * std::sin(a)),
               Vec3(degrees, 0, 0));
    }
  } else if (motion == "jump") {
    stretch(.1);
    stretch(10);
    stretch(.1);
  } else if (motion == "through") {
    // In one step through the upper hand: what follows linearly is inside out.
    stretch(-2.0);
    stretch(-1.0);
    stretch(0);
    steps.back().rigid = true;
    stretch(.1);
  } else if (motion == "tear") {
    stretch(.1);
    stretch(.2);
    const auto crack = test::elements_across(problem.mesh(), 27);
    for (std::size_t i = 0; i < 3; ++i) {
      stretch(.2);
      steps.back().destroyed.assign(crack.begin() + 4 * static_cast<long>(i),
                                    crack.begin() + 4 * static_cast<long>(i + 1));
    }
    stretch(.3);
  } else if (motion == "part") {
    part(problem, stretch, steps);
  } else {
    throw std::invalid_argument("unknown motion " + motion);
  }
  return steps;
}

}  // namespace sunder::bench
