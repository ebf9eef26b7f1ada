// SPDX-License-Identifier: Apache-2.0
#include "body/eight_products.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "body/element.hpp"
#include "machine/compiler.hpp"

namespace sunder::fem {
namespace {

using machine::Lanes8;
static_assert(sizeof(Lanes8) == kProductsAtOnce * sizeof(double));

/// By the differences to corner 0, as stress() takes them.
SUNDER_VECTORISED void add_element(const std::array<Index, 4>& corners, const TetShape& shape,
                                   const SmallStrain& law, double weight, const double* u,
                                   double* y) {
  Lanes8 first[3], h[3][3] = {};  // H_ij = du_i/dx_j
  for (int axis = 0; axis < 3; ++axis) {
    std::memcpy(&first[axis], u + kProductsAtOnce * (3 * corners[0] + axis), sizeof(Lanes8));
  }
  for (int a = 1; a < 4; ++a) {
    for (int axis = 0; axis < 3; ++axis) {
      Lanes8 d;
      std::memcpy(&d, u + kProductsAtOnce * (3 * corners[a] + axis), sizeof d);
      d = d + first[axis] * -1.0;
      for (int j = 0; j < 3; ++j) h[axis][j] = h[axis][j] + d * shape.gradient(j, a);
    }
  }
  const Lanes8 pressure = law.lambda * (h[0][0] + h[1][1] + h[2][2]);
  Lanes8 s[3][3];
  for (int i = 0; i < 3; ++i) {
    s[i][i] = pressure + 2 * law.mu * h[i][i];
    for (int j = 0; j < i; ++j) s[i][j] = s[j][i] = law.mu * (h[i][j] + h[j][i]);
  }
  for (int a = 0; a < 4; ++a) {
    for (int axis = 0; axis < 3; ++axis) {
      double* const to = y + kProductsAtOnce * (3 * corners[a] + axis);
      Lanes8 sum;
      std::memcpy(&sum, to, sizeof sum);
      sum = sum + weight * (s[axis][0] * shape.gradient(0, a) + s[axis][1] * shape.gradient(1, a) +
                            s[axis][2] * shape.gradient(2, a));
      std::memcpy(to, &sum, sizeof sum);
    }
  }
}

}  // namespace

void apply_stiffness_to_eight(const Problem& problem, std::span<const double> scale,
                              std::span<const double> u, std::span<double> y) {
  std::fill(y.begin(), y.end(), 0.0);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const TetShape& shape = problem.shape(e);
    const double weight = shape.volume * (scale.empty() ? 1.0 : scale[static_cast<std::size_t>(e)]);
    add_element(problem.mesh().tets[static_cast<std::size_t>(e)], shape, problem.small_strain(e),
                weight, u.data(), y.data());
  }
}

}  // namespace sunder::fem
