// SPDX-License-Identifier: Apache-2.0
// Bodies of a few elements under Deferred::change(), each change followed by a fresh solution too.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "body/assembly.hpp"
#include "body/element.hpp"
#include "changed_body.hpp"
#include "material/linear.hpp"
#include "solver/condensed_base.hpp"
#include "solver/deferred.hpp"
#include "solver/factor_base.hpp"
#include "solver/inverse_base.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

/// Of a solution after a change, against a fresh one.
inline constexpr double kTolerance = 1e-10;

/// A row of cells of six tetrahedra along x, held at x = 0, pulled or gripped at the other end.
struct BodyOf {
  Index nx = 3, ny = 1, nz = 1;
  double contrast = 1;  ///< of every other cell
  double poisson = 0.4;
  bool gripped = false;
  bool supported = true;  ///< else by grips alone
  std::string base = "factor";
};

/// Every base, with and without grips, stiff cells, nearly incompressible.
inline std::vector<BodyOf> bodies() {
  return {BodyOf{},
          BodyOf{.base = "inverse"},
          BodyOf{.base = "condensed"},
          BodyOf{.gripped = true},
          BodyOf{.contrast = 1e4},
          BodyOf{.contrast = 1e4, .gripped = true},
          BodyOf{.poisson = 0.499},
          BodyOf{.poisson = 0.499, .gripped = true}};
}

inline std::string name_of_body(const ::testing::TestParamInfo<BodyOf>& tested) {
  const BodyOf& b = tested.param;
  return b.base + (b.gripped ? "_gripped" : "") + (b.contrast > 1 ? "_contrast" : "") +
         (b.poisson > 0.4 ? "_incompressible" : "");
}

inline Scene scene_of(const BodyOf& b) {
  Scene scene;
  scene.mesh =
      structured_board({b.nx, b.ny, b.nz, 2.0 * b.nx, 2.0 * b.ny, 2.0 * b.nz}, [](const Vec3& x) {
        return std::string(static_cast<int>(x.x() / 2) % 2 == 1 ? "stiff" : "soft");
      });
  // No two edges of one length: nothing is exact by symmetry.
  for (std::size_t i = 0; i < scene.mesh.nodes.size(); ++i) {
    Vec3& x = scene.mesh.nodes[i];
    const auto k = static_cast<double>(i);
    if (x.x() > 0) x += 0.2 * Vec3(std::sin(3 * k), std::sin(5 * k + 1), std::sin(7 * k + 2));
  }
  for (const NamedVolume& v : scene.mesh.volumes) {
    scene.materials[v.name] = {v.name == "soft" ? 5.0 : 5.0 * b.contrast, b.poisson, 1e3};
  }
  const double far = 2.0 * b.nx;
  const Box near{Vec3(-0.01, -9e9, -9e9), Vec3(0.01, 9e9, 9e9)};
  if (b.supported) {
    scene.supports.push_back({near, Axes{7}});
  } else {
    Instrument other;
    other.name = "other forceps";
    other.action = Grip{near, Vec3::Constant(0.25), Axes{7}};
    scene.instruments.push_back(other);
  }
  Instrument tool;
  tool.name = "forceps";
  const Box end{Vec3(far - 0.5, -9e9, -9e9), Vec3(far + 0.5, 9e9, 9e9)};
  if (b.gripped) {
    tool.action = Grip{end, Vec3::Constant(0.25), Axes{7}};
  } else {
    tool.action = Pull{end, Vec3(1, 2, 3)};
  }
  scene.instruments.push_back(tool);
  return scene;
}

/// Two that share a face, held at x = 0.
inline Scene two_elements() {
  Scene scene = scene_of({});
  scene.mesh.nodes = {{0, 0, 0}, {0, 3, 0}, {0, 0, 3}, {3, 1, 1}, {3, 3, 3}};
  scene.mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  scene.mesh.volume_of = {0, 0};
  scene.instruments.clear();
  return scene;
}

/// A body as Deferred has it and as it is assembled afresh.
class Changing {
 public:
  explicit Changing(const BodyOf& body)
      : problem(scene_of(body)),
        of(body),
        factor(std::make_shared<linear_algebra::Factor>(fem::assemble_lower(problem, {}))),
        deferred(problem, base(body.base)),
        afresh(problem) {}

  [[nodiscard]] bool change(const fem::Change& change) {
    const Index events = deferred.events();
    if (!deferred.change(change)) return false;
    if (deferred.events() < events) {
      afresh = history.back();
      history.pop_back();
      return true;
    }
    history.push_back(afresh);
    afresh.follow(change);
    return true;
  }

  void take_back() {
    deferred.take_back();
    afresh = history.back();
    history.pop_back();
  }

  /// Forces at every node, new ones too, that nothing orders.
  [[nodiscard]] std::vector<double> forces() const {
    std::vector<double> f(3 * static_cast<std::size_t>(afresh.node_count()), 0.0);
    for (std::size_t i = 0; i < f.size(); ++i) {
      const auto node = static_cast<Index>(i / 3);
      if (unloaded && unloaded(node)) continue;
      if (in_use()[static_cast<std::size_t>(node)])
        f[i] = std::sin(1.0 + 2.3 * static_cast<double>(i));
    }
    return f;
  }

  /// u over the body's unknowns and d, one after the other.
  [[nodiscard]] Eigen::VectorXd solution() {
    std::vector<double> on(static_cast<std::size_t>(problem.dof_count() + 3 * new_nodes()), 0.0);
    const std::vector<double> f = forces();
    for (Index n = 0; n < afresh.node_count(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const double value = f[static_cast<std::size_t>(3 * n + axis)];
        const Index of_parent = problem.dof(afresh.parent(n), axis);
        if (of_parent != kNone) on[static_cast<std::size_t>(of_parent)] += value;
        if (n < problem.node_count()) continue;
        const Index own = deferred.unknown(n, axis);
        if (own != kNone) on[static_cast<std::size_t>(own)] += value;
      }
    }
    std::vector<Index> dofs;
    std::vector<double> values;
    const auto grips = problem.gripped_dofs();
    for (std::size_t i = 0; i < on.size(); ++i) {
      const auto d = static_cast<Index>(i);
      if (on[i] == 0 || std::binary_search(grips.begin(), grips.end(), d)) continue;
      dofs.push_back(d);
      values.push_back(on[i]);
    }
    Eigen::VectorXd u = Eigen::VectorXd::Zero(problem.dof_count());
    deferred.solve({dofs, values}, std::vector<double>(grips.size(), kGrip), u);
    Eigen::VectorXd all(u.size() + deferred.offsets().size());
    all << u, deferred.offsets();
    return all;
  }

  /// Relative, against the fresh solution: displacement (2-norm), stress of live elements
  /// (largest), forces of the grips (2-norm).
  struct Errors {
    double displacement, stress, grips = 0;
    [[nodiscard]] double largest() const { return std::max({displacement, stress, grips}); }
  };
  void compare(double tolerance) {
    const Errors e = errors();
    EXPECT_LE(e.displacement, tolerance);
    EXPECT_LE(e.stress, tolerance);
    EXPECT_LE(e.grips, tolerance);
  }
  [[nodiscard]] Errors errors() {
    const Eigen::VectorXd all = solution();
    const ChangedBody::Solution fresh = afresh.solve(forces(), kGrip);
    ChangedBody::Vector u = ChangedBody::Vector::Zero(3 * afresh.node_count());
    ChangedBody::Real off = 0, size = 0;
    for (Index n = 0; n < afresh.node_count(); ++n) {
      if (!in_use()[static_cast<std::size_t>(n)] || (ignored && ignored(n))) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Index of_parent = problem.dof(afresh.parent(n), axis);
        ChangedBody::Real& value = u[3 * n + axis];
        value = of_parent == kNone ? 0 : all[of_parent];
        if (n >= problem.node_count() && deferred.unknown(n, axis) != kNone) {
          value += all[deferred.unknown(n, axis)];
        }
        off += (value - fresh.u[3 * n + axis]) * (value - fresh.u[3 * n + axis]);
        size += fresh.u[3 * n + axis] * fresh.u[3 * n + axis];
      }
    }
    Errors errors{std::sqrt(static_cast<double>(off / size)), 0};
    ChangedBody::Real stress_off = 0, largest = 0;
    for (Index e = 0; e < afresh.element_count(); ++e) {
      const auto& c = afresh.corners(e);
      if (!afresh.live(e) || (ignored && std::any_of(c.begin(), c.end(), ignored))) continue;
      const auto expected = afresh.stress(e, fresh.u);
      const ChangedBody::Real difference = (afresh.stress(e, u) - expected).norm();
      if (!(difference <= stress_off)) stress_off = difference;
      largest = std::max(largest, expected.norm());
    }
    errors.stress = static_cast<double>(stress_off / largest);
    if (fresh.reactions.size() == 0) return errors;
    ChangedBody::Vector held = deferred.grip_forces().cast<ChangedBody::Real>();
    for (std::size_t i = 0; i < problem.gripped_dofs().size(); ++i) {
      if (std::ranges::count(problem.anchored_dofs(), problem.gripped_dofs()[i]) == 0) continue;
      held[static_cast<Eigen::Index>(i)] -= problem.anchor_stiffness() * kGrip;
    }
    errors.grips = static_cast<double>((held + applied_at_grips() - fresh.reactions).norm() /
                                       fresh.reactions.norm());
    return errors;
  }

  /// Elements that come with the form they have now but for what `alter` does to it.
  [[nodiscard]] fem::Change again(std::vector<Index> elements,
                                  const std::function<void(fem::Form&)>& alter) const {
    fem::Change change;
    for (Index e : elements) {
      change.come.push_back({e, deferred.forms().of(e)});
      alter(change.come.back().form);
    }
    return change;
  }
  [[nodiscard]] fem::Change healed(std::vector<Index> elements) const {
    return again(std::move(elements), [](fem::Form& form) { form.share = 1; });
  }
  [[nodiscard]] fem::Change stiffened(std::vector<Index> elements, double times) const {
    return again(std::move(elements), [times](fem::Form& form) {
      form.law = small_strain({times * form.law.young, form.law.poisson, std::nullopt});
      form.share = 1;
    });
  }

  /// Doubles nodes; the elements that `moves` names take the new ones.
  [[nodiscard]] fem::Change split(const std::vector<Index>& nodes,
                                  const std::function<bool(Index)>& moves, Axes axes = {}) const {
    fem::Change change;
    for (Index n : nodes) change.nodes.push_back({n, axes});
    for (Index e = 0; e < afresh.element_count(); ++e) {
      fem::Form form = deferred.forms().of(e);
      bool at = false;
      for (Index& c : form.corners) {
        const auto found = std::find(nodes.begin(), nodes.end(), c);
        if (found == nodes.end()) continue;
        at = true;
        c = afresh.node_count() + static_cast<Index>(found - nodes.begin());
      }
      if (at && moves(e)) change.come.push_back({e, form});
    }
    return change;
  }

  /// Mean of the corners before any change.
  [[nodiscard]] Vec3 centre(Index e) const {
    Vec3 sum = Vec3::Zero();
    for (Index n : afresh.corners(e)) sum += problem.mesh().nodes[afresh.parent(n)];
    return sum / 4;
  }

  [[nodiscard]] Index new_nodes() const { return afresh.node_count() - problem.node_count(); }

  static constexpr double kGrip = 0.25;
  Problem problem;
  BodyOf of;
  std::shared_ptr<const linear_algebra::Factor> factor;
  solver::Deferred deferred;
  ChangedBody afresh;
  std::vector<ChangedBody> history;
  std::function<bool(Index)> ignored, unloaded;  ///< nodes

 private:
  [[nodiscard]] std::unique_ptr<solver::Base> base(const std::string& name) const {
    if (name == "inverse") return std::make_unique<solver::InverseBase>(*factor);
    if (name == "factor") return std::make_unique<solver::FactorBase>(*factor);
    std::vector<Index> all(static_cast<std::size_t>(problem.dof_count()));
    std::iota(all.begin(), all.end(), 0);
    return std::make_unique<solver::CondensedBase>(factor, all);
  }

  /// Nodes of some element.
  [[nodiscard]] std::vector<char> in_use() const {
    std::vector<char> used(static_cast<std::size_t>(afresh.node_count()), 0);
    for (Index e = 0; e < afresh.element_count(); ++e) {
      for (Index n : afresh.corners(e)) used[static_cast<std::size_t>(n)] = 1;
    }
    return used;
  }

  /// Forces at gripped unknowns are left out of the solution: the grip would take them.
  [[nodiscard]] ChangedBody::Vector applied_at_grips() const {
    const auto grips = problem.gripped_dofs();
    ChangedBody::Vector applied =
        ChangedBody::Vector::Zero(static_cast<Eigen::Index>(grips.size()));
    const std::vector<double> f = forces();
    for (std::size_t i = 0; i < f.size(); ++i) {
      const auto n = static_cast<Index>(i / 3);
      const int axis = static_cast<int>(i % 3);
      const Index of_parent = problem.dof(afresh.parent(n), axis);
      const auto at = std::find(grips.begin(), grips.end(), of_parent);
      if (of_parent == kNone || at == grips.end()) continue;
      applied[at - grips.begin()] -= static_cast<ChangedBody::Real>(f[i]);
    }
    return applied;
  }
};

inline fem::Change leaving(std::vector<Index> elements) { return {std::move(elements), {}, {}}; }

}  // namespace sunder::test
