// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/conjugate_gradient.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::cpu_reference {

CgResult conjugate_gradient(const LinearMap& a, const LinearMap& preconditioner,
                            const Eigen::VectorXd& b, const CgStop& stop, Eigen::VectorXd& x) {
  CgResult result;
  x = Eigen::VectorXd::Zero(b.size());
  Eigen::VectorXd r = b, z(b.size()), p(b.size()), ap(b.size());
  preconditioner(r, z);
  double rz = r.dot(z);
  const double target = std::max(stop.absolute, stop.relative * rz);
  if (!(rz > target)) {
    result.converged = rz <= target;
    return result;
  }
  p = z;
  while (result.iterations < stop.max_iterations) {
    ++result.iterations;
    a(p, ap);
    const double pap = p.dot(ap);
    if (!(pap > 0) || !std::isfinite(pap)) return result;
    const double step = rz / pap;
    x += step * p;   // x = x + alpha p
    r -= step * ap;  // r = r - alpha A p
    preconditioner(r, z);
    const double rz_new = r.dot(z);
    if (!std::isfinite(rz_new)) return result;
    if (rz_new <= target) {
      result.converged = true;
      return result;
    }
    p = z + (rz_new / rz) * p;
    rz = rz_new;
  }
  return result;
}

}  // namespace sunder::cpu_reference
