// SPDX-License-Identifier: Apache-2.0
// The damaged body: the one record of what has left and come, and what every element is after it.
// Whoever asks what is destroyed asks here; whoever computes (bases, fields, buffers of a device)
// follows an event once it is recorded. A copy reads the same record at an event of its own, as the
// thread does that makes a new base beside the frames.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "body/change.hpp"
#include "linear_algebra/sparse_matrix.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

class DamagedBody {
 public:
  /// Intact, with a record of its own.
  explicit DamagedBody(std::shared_ptr<const Problem> problem);
  /// For events that destroy each element once: they allocate nothing, where nothing pools.
  void reserve();

  /// Records an event and follows it. On the body that began the record alone.
  void destroy(std::span<const Index> elements);
  /// The same of any change. False, and nothing is recorded: a piece would hang on nothing, for
  /// which a grip does not count. Throws UsageError when the change does not fit the body.
  [[nodiscard]] bool change(const Change& change);
  /// The same of unknowns that grips take hold of and let go.
  void grip(std::span<const Index> grasp, std::span<const Index> release);

  /// Events of the record that the body has followed.
  [[nodiscard]] std::size_t events() const { return events_; }
  /// Follows the record up to so many events, no fewer than now.
  void follow(std::size_t events);
  /// Follows the record's next event, as read() gave it; `more`: as Forms::follow().
  void follow(const Event& event, bool more = false);
  /// Drops all events but so many, as if they had not been. On the body that began the record
  /// alone; a copy that has followed more is of no use any more.
  void take_back(std::size_t events);
  /// The body after so many of its events.
  [[nodiscard]] DamagedBody as_of(std::size_t events) const;
  /// An event of the record.
  void read(std::size_t event, Change& change) const;
  /// Elements of the events from `begin` on, before `end`, each once, in the order of the events.
  [[nodiscard]] std::vector<Index> changed(std::size_t begin, std::size_t end) const;

  /// 1 per destroyed element of the mesh.
  [[nodiscard]] std::span<const std::uint8_t> destroyed() const { return forms_.destroyed(); }
  /// a_e per element of the mesh: 1 or alpha, what it came with, or 0 where it came as other matter
  /// (others()).
  [[nodiscard]] std::span<const double> scale() const { return scale_; }
  /// Forms that differ from the mesh's by more than their share of stiffness.
  [[nodiscard]] std::span<const Form> others() const { return others_; }
  [[nodiscard]] const Forms& forms() const { return forms_; }

  /// Throws UsageError where there are new unknowns, as all that follows does.
  void refuse_new_unknowns() const;
  /// K over the unknowns, anchors included: its lower triangle.
  [[nodiscard]] linear_algebra::SparseMatrix stiffness() const;
  /// y = K x over the unknowns, without anchors.
  void apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  /// The same of several x, shape (n x columns): in a seventh of the time each where the body pools
  /// no volume and has parted nowhere.
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd& y) const;
  /// Largest stress norm (Frobenius, MPa) over live elements of the displacement x.
  [[nodiscard]] double largest_stress(const Eigen::VectorXd& x) const;
  /// Over live ones of some elements of the mesh.
  [[nodiscard]] double largest_stress(const Eigen::VectorXd& x,
                                      std::span<const Index> elements) const;
  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const std::shared_ptr<const Problem>& shared_problem() const { return problem_; }

 private:
  struct Record {
    std::mutex mutex;  // one thread adds, others read
    Damage damage;
  };
  void record(const Event& event);
  void scatter(const Eigen::VectorXd& x) const;

  std::shared_ptr<const Problem> problem_;
  std::shared_ptr<Record> record_;
  std::size_t events_ = 0;
  Forms forms_;                // after them; what follows is read off it
  std::vector<double> scale_;  // per element of the mesh
  std::vector<Form> others_;   // by id
  mutable std::vector<double> nodal_in_, nodal_out_;
  mutable std::vector<double> eight_in_, eight_out_;
};

}  // namespace sunder::fem
