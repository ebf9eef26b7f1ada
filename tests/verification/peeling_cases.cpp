// SPDX-License-Identifier: Apache-2.0
#include "verification/peeling_cases.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "body/hyperelastic.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "sunder/interfaces.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

constexpr double kBeside = 1e-6;

/// A case: two layers of one length, the upper one peeled off the lower one from x = 0 on.
struct Case {
  double young, poisson, strength, energy;
  double length, height, bed;  // of the upper and the lower layer [mm]
  double free;                 // length that is not joined [mm]
  double way, steady;          // of the grip, and from where the force is steady [mm]
  double cell;                 // of the coarsest mesh [mm]
  double per_way;              // how far the edge moves on for 1 mm of the grip's way
};

Case case_of(Peel peel) {
  const Case strip{.young = 0.5,
                   .poisson = 0.45,
                   .strength = 0.14,
                   .energy = 0.0458,
                   .length = 12,
                   .height = 0.6,
                   .bed = 0.3,
                   .free = 2.1,
                   .way = 8,
                   .steady = 4,
                   .cell = 0.3,
                   .per_way = 1};
  Case of = strip;
  if (peel == Peel::at_180) {
    of.free = 4.8;
    of.way = 14;
    of.steady = 6;
    of.per_way = 0.5;
  } else if (peel == Peel::t_peel) {
    of.bed = of.height;
    of.way = 16;
    of.steady = 8;
    of.per_way = 0.5;
  } else if (peel == Peel::double_cantilever) {
    of = {.young = 100,
          .poisson = 0.3,
          .strength = 0.2,
          .energy = 0.01,
          .length = 24,
          .height = 2,
          .bed = 2,
          .free = 6,
          .way = 2.2,
          .steady = 0.7,
          .cell = 0.5,
          .per_way = 4};
  }
  return of;
}

double edge(const Case& of, Index finer) { return of.cell / static_cast<double>(finer); }
double plane_strain(const Case& of) { return of.young / (1 - of.poisson * of.poisson); }

/// Nodes of a line across the strip at its free end.
Box end_line(double z) {
  return {Vec3(-kBeside, -1, z - kBeside), Vec3(kBeside, 1e3, z + kBeside)};
}

Scene scene_of(Peel peel, Index finer) {
  const Case of = case_of(peel);
  const double h = edge(of, finer), top = of.bed + of.height;
  const auto cells = [&](double mm) { return static_cast<Index>(std::lround(mm / h)); };
  Scene scene;
  scene.mesh = structured_board({cells(of.length), 1, cells(top), of.length, h, top},
                                [&](const Vec3& x) { return x.z() < of.bed ? "lower" : "upper"; });
  Material material{of.young, of.poisson, std::nullopt};
  material.law = MaterialLaw::neo_hookean;
  scene.materials = {{"lower", material}, {"upper", material}};
  scene.interfaces.push_back({{"lower", "upper"}, of.strength, of.energy, 1});
  scene.removals.push_back(
      {0, Box{Vec3(-1, -1, of.bed - 0.1 * h), Vec3(of.free, 1e3, of.bed + 0.1 * h)}});
  scene.supports.push_back({Box{Vec3::Constant(-1), Vec3::Constant(1e3)}, Axes{2}});
  const bool rigid = peel == Peel::at_90 || peel == Peel::at_180;
  if (rigid) {
    scene.supports.push_back({Box{Vec3::Constant(-1), Vec3(1e3, 1e3, of.bed)}, Axes{5}});
  } else {
    scene.supports.push_back({end_line(of.bed / 2), Axes{5}});
  }
  Instrument grip;
  grip.name = "grip";
  grip.action = Grip{end_line(of.bed + of.height / 2), Vec3::Zero(),
                     Axes{static_cast<std::uint8_t>(peel == Peel::at_90 ? 4 : 5)}};
  scene.instruments.push_back(grip);
  scene.fracture.model = FractureModel::p;
  scene.steps = std::numeric_limits<int>::max();
  return scene;
}

/// Where the grip is after a way of s [mm].
Vec3 at(Peel peel, const Case& of, double s) {
  if (peel != Peel::at_180) return {0, 0, s};
  // First the free end is folded back without being pulled taut, to the height that it keeps.
  const double radius = 0.65 * of.free, height = 1.4;
  if (s > 0) return {2 * radius + s, 0, height};
  const double angle = std::numbers::pi * (1 + s / (std::numbers::pi * radius));
  return {radius * (1 - std::cos(angle)), 0,
          radius * std::sin(angle) + height * angle / std::numbers::pi};
}
double start(Peel peel, const Case& of) {
  return peel == Peel::at_180 ? -std::numbers::pi * 0.65 * of.free : 0;
}

/// Force a width [N/mm] and energy per area [N/mm] of a strip in plane strain that is stretched.
struct Stretched {
  double force = 0, energy = 0;
};
Stretched stretched(const Case& of, double stretch) {
  const double mu = of.young / (2 * (1 + of.poisson));
  const double lambda = of.young * of.poisson / ((1 + of.poisson) * (1 - 2 * of.poisson));
  double low = 0.1, high = 2;  // stretch across, at which its stress is zero
  for (int i = 0; i < 100; ++i) {
    const double z = (low + high) / 2;
    (mu * z * z - mu + lambda * std::log(stretch * z) < 0 ? low : high) = z;
  }
  const double log_j = std::log(stretch * low);
  return {of.height * (mu * stretch - (mu - lambda * log_j) / stretch),
          of.height * (mu / 2 * (stretch * stretch + low * low - 2) - mu * log_j +
                       lambda / 2 * log_j * log_j)};
}

/// Force a width that peels a strip off which stretches: G = N (stretch - cos angle) - W, of which
/// two arms share G.
double peeling_force(const Case& of, double cosine, double energy) {
  double low = 1, high = 2;
  for (int i = 0; i < 100; ++i) {
    const double stretch = (low + high) / 2;
    const Stretched s = stretched(of, stretch);
    (s.force * (stretch - cosine) - s.energy < energy ? low : high) = stretch;
  }
  return stretched(of, low).force;
}

/// Forces a width in the steady part.
struct Theory {
  double rigid = 0, stretching = 0;
};
Theory theory(Peel peel, const Case& of, double a) {
  switch (peel) {
    case Peel::at_90:
      return {of.energy, peeling_force(of, 0, of.energy)};
    case Peel::at_180:
      return {of.energy / 2, peeling_force(of, -1, of.energy)};
    case Peel::t_peel:
      return {of.energy / 2, peeling_force(of, 0, of.energy / 2)};
    case Peel::double_cantilever:
      break;
  }
  // Each arm is a beam; beyond the edge it lies on springs of half the opening.
  const double bending = plane_strain(of) * std::pow(of.height, 3) / 12;
  const double springs = of.strength * of.strength / (2 * of.energy);
  const double root = std::pow(4 * bending / (2 * springs), 0.25);
  const double force = std::sqrt(of.energy * bending) / (a + root);
  return {force, force};
}

class Peeling {
 public:
  Peeling(Peel peel, Index finer)
      : peel_(peel),
        of_(case_of(peel)),
        width_(edge(of_, finer)),
        problem_(std::make_shared<const Problem>(scene_of(peel, finer))),
        laws_(fem::laws_of(*problem_)),
        simulation_(problem_, cpu_reference::create(problem_, needs_of(*problem_))) {
    simulation_.observe_frames([this] {
      now_ = simulation_.reactions()[0];
      if (solves_++ == 0) loaded_ = now_;
    });
  }

  PeelFigures run(double per_cell) {
    PeelFigures figures;
    figures.tets = problem_->tet_count();
    const double step = width_ / (per_cell * of_.per_way);
    const auto begin = std::chrono::steady_clock::now();
    for (double s = start(peel_, of_) + step; s <= of_.way + kBeside; s += step) {
      go_to(s);
      if (s < of_.steady) continue;
      if (!began_) begin_steady();
      see(figures);
    }
    figures.ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    finish(figures);
    return figures;
  }

 private:
  void go_to(double s) {
    const Vec3 before = now_, from = place_;
    place_ = at(peel_, of_, s);
    simulation_.drive(0, place_);
    solves_ = 0;
    simulation_.step();
    work_ += (before + loaded_).dot(place_ - from) / 2;
    for (; seen_ < simulation_.destroyed().size(); ++seen_) {
      const DestroyedElement& gone = simulation_.destroyed()[seen_];
      area_ += problem_->interfaces()->area(gone.element);
      spent_ += gone.energy.value_or(0);
    }
  }

  [[nodiscard]] double stored() const {
    std::vector<std::uint8_t> gone(static_cast<std::size_t>(problem_->tet_count()), 0);
    for (const auto& d : simulation_.destroyed()) gone[static_cast<std::size_t>(d.element)] = 1;
    std::vector<double> u;
    for (const Vec3& v : simulation_.displacement()) u.insert(u.end(), v.begin(), v.end());
    return fem::energy({*problem_, laws_, gone}, u);
  }
  [[nodiscard]] double pull(const Vec3& force) const {
    return std::abs(peel_ == Peel::at_180 ? force.x() : force.z()) / width_;
  }
  [[nodiscard]] double edge_at() const { return area_ / width_; }

  void begin_steady() {
    began_ = true;
    work_0_ = work_ - stored();
    area_0_ = area_;
    spent_0_ = spent_;
  }
  void see(PeelFigures& figures) {
    const Theory of = theory(peel_, of_, edge_at());
    const double force = pull(now_);
    ++frames_;
    figures.over_rigid += force / of.rigid;
    figures.mean += force / of.stretching;
    const double low = force / of.stretching, high = pull(loaded_) / last_;
    figures.least = frames_ == 1 ? low : std::min(figures.least, low);
    if (frames_ > 1) figures.largest = std::max(figures.largest, high);
    last_ = of.stretching;
  }
  void finish(PeelFigures& figures) const {
    figures.over_rigid /= frames_;
    figures.mean /= frames_;
    const double asked = of_.energy * (area_ - area_0_);
    figures.work = (work_ - stored() - work_0_) / asked;
    figures.parted = (spent_ - spent_0_) / asked;
    figures.rows = static_cast<int>(std::lround((area_ - area_0_) / (width_ * width_)));
  }

  Peel peel_;
  Case of_;
  double width_;
  std::shared_ptr<const Problem> problem_;
  std::vector<const Law*> laws_;
  Simulation simulation_;
  Vec3 now_ = Vec3::Zero(), loaded_ = Vec3::Zero(), place_ = Vec3::Zero();
  int solves_ = 0, frames_ = 0;
  std::size_t seen_ = 0;
  bool began_ = false;
  double work_ = 0, area_ = 0, spent_ = 0, work_0_ = 0, area_0_ = 0, spent_0_ = 0, last_ = 0;
};

}  // namespace

std::string name_of(Peel peel) {
  switch (peel) {
    case Peel::at_90:
      return "strip at 90 deg";
    case Peel::at_180:
      return "strip at 180 deg";
    case Peel::t_peel:
      return "T-peel";
    case Peel::double_cantilever:
      break;
  }
  return "double cantilever";
}

double coarse_cell(Peel peel) { return case_of(peel).cell; }

PeelFigures peel(Peel peel, Index finer, double per_cell) {
  return Peeling(peel, finer).run(per_cell);
}

}  // namespace sunder::test
