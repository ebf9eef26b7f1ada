// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/low_rank.hpp"

#include <Eigen/Cholesky>

namespace sunder::cpu_reference {

bool update_inverse(const fem::EventFactor& event, Eigen::MatrixXd& x) {
  if (event.dofs.empty()) return true;  // every corner is held: nothing changes
  const Eigen::MatrixXd xw = x(Eigen::all, event.dofs) * event.w;
  Eigen::MatrixXd c = -event.w.transpose() * xw(event.dofs, Eigen::all);
  c.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> llt(c);
  if (llt.info() != Eigen::Success || !llt.matrixLLT().allFinite()) return false;
  const Eigen::MatrixXd z = llt.matrixL().solve(xw.transpose()).transpose();
  if (!z.allFinite()) return false;
  x.noalias() += z * z.transpose();
  return true;
}

}  // namespace sunder::cpu_reference
