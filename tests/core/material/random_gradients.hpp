// SPDX-License-Identifier: Apache-2.0
// Deformation gradients to try laws on, by a fixed seed.
#pragma once

#include <Eigen/Geometry>
#include <random>

#include "sunder/types.hpp"

namespace sunder::test {

class RandomGradients {
 public:
  explicit RandomGradients(unsigned seed) : generator_(seed) {}
  /// In [low, high).
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  Vec3 vector() { return {number(-1, 1), number(-1, 1), number(-1, 1)}; }
  Mat3 matrix() {
    Mat3 m;
    m << vector(), vector(), vector();
    return m;
  }
  /// Evenly distributed over all rotations.
  Mat3 rotation() {
    std::normal_distribution<double> any;
    Eigen::Quaterniond q(any(generator_), any(generator_), any(generator_), any(generator_));
    return q.normalized().toRotationMatrix();
  }
  /// U diag(stretches) V^T with random rotations.
  Mat3 turned(const Vec3& stretches) { return rotation() * stretches.asDiagonal() * rotation(); }

 private:
  std::mt19937 generator_;
};

}  // namespace sunder::test
