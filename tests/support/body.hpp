// SPDX-License-Identifier: Apache-2.0
// A problem with a backend of the CPU reference, driven below the frame: any nodal load, any
// sequence of removals.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/backend.hpp"
#include "sunder/problem.hpp"
#include "support/loads.hpp"

namespace sunder::test {

struct Body {
  explicit Body(Scene scene, Needs needs = all_needs())
      : problem(std::make_shared<Problem>(std::move(scene))),
        backend(cpu_reference::create(problem, std::move(needs))) {}

  /// Sets nodal forces (3 * nodes; entries at supports are dropped) and the grips' displacements.
  void load(std::span<const double> force, std::vector<double> displacements = {}) const {
    backend->set_load(load_of(*problem, force, std::move(displacements)));
  }

  [[nodiscard]] std::vector<double> displacement() const {
    std::vector<double> u(problem->dofs().size());
    backend->read_displacement(u);
    return u;
  }

  [[nodiscard]] std::vector<Voigt> stress() const {
    std::vector<Voigt> s(problem->mesh().tets.size());
    backend->stress();
    backend->read_stress(s);
    return s;
  }

  [[nodiscard]] std::vector<double> reactions() const {
    std::vector<double> r(problem->gripped_dofs().size());
    backend->read_reactions(r);
    return r;
  }

  /// a_e per element: 1, or alpha where destroyed.
  [[nodiscard]] std::vector<double> scale() const {
    std::vector<double> scale;
    for (auto d : backend->destroyed()) {
      scale.push_back(d ? problem->scene().fracture.alpha : 1.0);
    }
    return scale;
  }

  std::shared_ptr<const Problem> problem;
  std::unique_ptr<Backend> backend;
};

}  // namespace sunder::test
