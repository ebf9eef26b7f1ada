// SPDX-License-Identifier: Apache-2.0
#include "gpu/finite_tables.hpp"

#include <algorithm>

#include "body/pooled_law.hpp"
#include "material/corotated.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"
#include "shaders/layout.h"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

std::uint32_t number_of(const Law& law) {
  const Law* const known[] = {&kLinear, &kCorotated, &kNeoHookean, &kSaintVenantKirchhoff};
  const auto* at = std::ranges::find(known, &law);
  if (at == std::end(known)) {
    throw DeviceError("shaders/finite_law.glsl does not know this law; use backend cpu");
  }
  return static_cast<std::uint32_t>(at - known);
}

std::uint32_t patch_of(const fem::HyperelasticBody& body, Index e) {
  if (!fem::pools_volume(body, e)) return 0;
  return shaders::kFinitePooled |
         shaders::kFinitePatch * static_cast<std::uint32_t>(body.pools()->of(e));
}

}  // namespace

Patches patches_of(const fem::HyperelasticBody& body) {
  Patches all;
  const fem::Pools* pools = body.pools();
  for (Index p = 0; pools && p < pools->count(); ++p) {
    for (Index e : pools->elements(p)) all.elements.push_back(static_cast<std::uint32_t>(e));
    all.first.push_back(static_cast<std::uint32_t>(all.elements.size()));
  }
  return all;
}

std::vector<std::uint32_t> corners_of(const Problem& problem) {
  std::vector<std::uint32_t> all;
  all.reserve(4 * problem.mesh().tets.size());
  for (const auto& tet : problem.mesh().tets) {
    for (Index n : tet) all.push_back(static_cast<std::uint32_t>(n));
  }
  return all;
}

std::vector<double> shapes_of(const Problem& problem) {
  std::vector<double> all;
  all.reserve(shaders::kFiniteShape * problem.mesh().tets.size());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const TetShape& of = problem.shape(e);
    for (int corner = 1; corner < 4; ++corner) {
      for (int axis = 0; axis < 3; ++axis) all.push_back(of.gradient(axis, corner));
    }
    const SmallStrain& constants = problem.small_strain(e);
    all.insert(all.end(), {of.volume, constants.mu, constants.lambda});
  }
  return all;
}

std::vector<double> fibres_of(const Problem& problem) {
  std::vector<double> all;
  if (!problem.fibrous()) return all;
  const std::size_t size = std::size_t{shaders::kFiniteFibres} * problem.mesh().tets.size();
  all.reserve(size);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const ElementFibres* of = problem.small_strain(e).fibres;
    const ElementFibres fibres = of ? *of : ElementFibres{};
    for (const FibreFamily& f : fibres.family) {
      all.insert(all.end(),
                 {f.direction.x(), f.direction.y(), f.direction.z(), f.k1, f.k2, f.dispersion});
    }
    const AlongFibres& linear = fibres.linear;
    all.insert(all.end(), {linear.lambda, linear.alpha, linear.beta, linear.mu});
  }
  return all;
}

std::vector<std::uint32_t> facts_of(const solver::RestingBody& body) {
  const Problem& problem = body.body().problem;
  std::vector<std::uint32_t> all;
  all.reserve(problem.mesh().tets.size());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    all.push_back((body.out()[static_cast<std::size_t>(e)] ? shaders::kFiniteOut : 0) |
                  (problem.in_interface(e) ? shaders::kFiniteLayer : 0) |
                  (problem.small_strain(e).fibres ? shaders::kFiniteFibrous : 0) |
                  patch_of(body.body(), e) | shaders::kFiniteLaw * number_of(body.body().law(e)));
  }
  return all;
}

}  // namespace sunder::gpu
