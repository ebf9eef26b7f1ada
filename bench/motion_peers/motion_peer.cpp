// SPDX-License-Identifier: Apache-2.0
#include "bench/motion_peers/motion_peer.hpp"

#include <cmath>

#include "body/lumped_mass.hpp"
#include "material/corotated.hpp"

namespace sunder::bench {
namespace {

constexpr double kDensity = 1e-9;  // water [t/mm^3]
// As in solver/finite_minimiser.cpp.
constexpr double kArmijo = 1e-4, kEnergyRounding = 1e-13, kLeastPart = 1e-7;

}  // namespace

Scene MotionBoard::scene(Index cells) {
  Scene scene = TearingBoard::scene({cells, cells, 1, 50, 50, 2.5});
  for (auto& [name, material] : scene.materials) material.density = kDensity;
  Instrument hand;
  hand.name = "hand";
  hand.action = Grip{Box{Vec3(49.99, -1, -1), Vec3(51, 0.01, 4)}, Vec3::Zero(), Axes{7}};
  scene.instruments.push_back(hand);
  scene.dynamics = Dynamics{.time_step = 0.005};
  return scene;
}

MotionBoard::MotionBoard(Index cells)
    : problem(scene(cells)),
      laws(fem::one_law(problem, kCorotated)),
      node_mass(fem::lumped_masses(problem)),
      mass(static_cast<std::size_t>(problem.dof_count()), 0.0) {
  for (std::size_t i = 0; i < problem.dofs().size(); ++i) {
    if (problem.dofs()[i] != kNone) mass[problem.dofs()[i]] = node_mass[i / 3];
  }
  for (Index d : problem.gripped_dofs()) {
    axis.push_back(
        static_cast<int>((std::ranges::find(problem.dofs(), d) - problem.dofs().begin()) % 3));
  }
}

Load MotionBoard::pulled(double down) const {
  Load load;
  for (const int of : axis) load.displacements.push_back(of == 1 ? -down : 0);
  return load;
}

MotionPeer::MotionPeer(const MotionBoard& board, double tolerance, int most)
    : board_(board),
      destroyed_(board.problem.mesh().tets.size(), 0),
      torn_{board.problem, board.laws, destroyed_},
      moving_(torn_, solver::RestingBody::Loose::moving),
      potential_(moving_, StressMeasure::cauchy),
      tolerance_(tolerance),
      energy_rounding_(solver::finite_scale(board.problem).energy_rounding),
      most_(most) {}

void MotionPeer::destroy(std::span<const Index> elements) {
  for (Index e : elements) destroyed_[e] = 1;
  moving_.look();
  potential_.body_changed();
  body_changed();
}

bool MotionPeer::at_end() const {
  return state_.r.norm() <= tolerance_ * std::max(state_.acting, 1e-12);
}

MotionSolved MotionPeer::step(const solver::FiniteMotionPast& past, const Load& load, double dt) {
  const bool second = past.euler == 0;
  const double rate = (second ? 1.5 : 1.0) / dt;
  solver::FiniteTarget target = potential_.target(load);
  target.inertia = {rate * rate, board_.mass};
  ahead_ = past.u;
  for (std::size_t i = 0; i < ahead_.size(); ++i) {
    const double u = second ? (4 * past.u[i] - past.u_before[i]) / 3 : past.u[i];
    const double v = second ? (4 * past.v[i] - past.v_before[i]) / 3 : past.v[i];
    ahead_[i] = u + v / rate;
  }
  target.ahead = &ahead_;
  state_.u = past.u;
  for (std::size_t i = 0; i < ahead_.size(); ++i) state_.u[i] += dt * past.v[i];
  potential_.put_grips(target, state_.u);
  potential_.evaluate(target, false, state_);
  factors_ = 0;
  begin();
  MotionSolved solved = minimise(target);
  solved.factors = factors_;
  return solved;
}

MotionSolved MotionPeer::minimise(const solver::FiniteTarget& target) {
  MotionSolved solved;
  Eigen::VectorXd du, s, y;
  for (;;) {
    solved.ended = at_end();
    if (solved.ended || solved.iterations == most_) return solved;
    ++solved.iterations;
    if (!direction(target, du)) return solved;
    potential_.hold(du);
    const double slope = state_.r.dot(du);
    if (!(slope < 0)) return solved;
    const double rounding = energy_rounding_ + kEnergyRounding * std::abs(state_.potential);
    double part = 1;
    for (; part > kLeastPart; part /= 2) {
      potential_.move(state_.u, part, du, next_.u);
      potential_.evaluate(target, false, next_);
      if (next_.potential <= state_.potential + kArmijo * part * slope + rounding) break;
    }
    if (part <= kLeastPart) return solved;
    potential_.difference(next_.u, state_.u, s);
    y = next_.r - state_.r;
    moved(s, y);
    std::swap(state_, next_);
  }
}

}  // namespace sunder::bench
