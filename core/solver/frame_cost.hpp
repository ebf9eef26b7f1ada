// SPDX-License-Identifier: Apache-2.0
// What a frame will take, from the values that it reads, the columns that an update carries through
// the factor and, on a device apart from the host, the passes that it is made of. For `plan`: right
// to a small factor, and in the right order between routes; `plan --measure` measures.
#pragma once

#include <cstddef>

#include "linear_algebra/supernodal_cholesky.hpp"
#include "sunder/backend.hpp"

namespace sunder::solver {

/// Of an element's stress on a device, principal ones and summary among them: so many by the kernel
/// that measures a device take as long (lavapipe).
inline constexpr double kStressFlops = 900;

/// Nominal rates of what computes frames. A host computes all of one; a device apart from it the
/// fields, and the products with its base.
struct FrameRates {
  double stress = 15e-9;  ///< [s] of an element: stress, with what is summed of it
  double frame = 5e-6;    ///< [s] of a frame's small changes on the host
  double event = 5e-6;    ///< [s] of an event's small matrices there
  // Of a device apart from the host: bytes a second, from memory or, for small sets, the cache; [s]
  // of a submit with its fence, of a dispatch with its barrier. 0 bytes a second: there is none.
  double bytes = 0, submit = 0, dispatch = 0;
  double flops = 0;       ///< a second there, in fp64; a multiply-add is two
  bool measured = false;  ///< on the device itself; else of its kind
  [[nodiscard]] bool apart() const { return bytes > 0; }
};

struct FrameShape {
  Route route = Route::inverse;
  bool eager = false;
  bool damage = false;        ///< something can be destroyed
  std::size_t unknowns = 0;   ///< of the body
  std::size_t kept = 0;       ///< rows of the dense inverse: all, or those of a condensed region
  std::size_t loaded = 0;     ///< unknowns with a force
  std::size_t grips = 0;      ///< gripped unknowns
  std::size_t entries = 0;    ///< of the host's factor L; 0: no frame reads one
  std::size_t path = 0;       ///< of them on the elimination path of one element
  std::size_t load_path = 0;  ///< of them on the elimination path of the loaded unknowns
  std::size_t elements = 0;   ///< of the body
  std::size_t stressed = 0;   ///< elements whose stress a frame computes
  std::size_t threads = 1;    ///< that share the stress
  // Of a device apart from the host.
  bool apart = false;               ///< the base is there
  bool host_corrects = false;       ///< it lacks shaderFloat64
  bool stress = false;              ///< is kept there
  std::size_t real_bytes = 8;       ///< of a value of stress
  std::size_t inverse_bytes = 8;    ///< of a value of the inverse
  bool columns_there = false;       ///< the device has it in fp64: new exact columns are read
  bool columns_refined = false;     ///< once, on the host, however they come
  std::size_t exact_loads = 0;      ///< up to so many loads have columns in fp64
  std::size_t stiffness_bytes = 0;  ///< that f - K u reads
  std::size_t groups = 1;           ///< whose rigid motions precondition its conjugate gradients
  std::size_t columns = 0;          ///< of the damage before this frame
  bool region_there = false;        ///< the device multiplies a region's inverse by it
  std::size_t touched = 0;          ///< unknowns of the region that it touches then
  bool damage_there = false;        ///< and solves with the small matrices
};

/// What a frame takes, and what of that is a device's apart from the host.
struct FrameSum {
  double ms = 0;
  double submits = 0, dispatches = 0;
  double bytes = 0;  ///< that its passes read and write at least
  double flops = 0;  ///< of its passes; a multiply-add is two
};

/// A frame's work, added up as it comes.
class FrameWork {
 public:
  explicit FrameWork(const FrameRates& rates) : rates_(rates) {}
  void seconds(double s) { seconds_ += s; }
  /// On the host: values of 8 bytes that it reads so many times, each time with so many flops of
  /// panels.
  void host(double values, double times = 1, double flops = 0);
  /// The product K u there, by plain loops over so many elements.
  void product(double elements);
  // On a device apart from it; on the host nothing.
  void submit();
  void pass(double bytes, double flops = 0) { passes(1, bytes, flops); }
  void passes(double dispatches, double bytes, double flops = 0);
  /// Stress with its summary, and f - K u where it does not come with the stress.
  void fields(const FrameShape& shape, bool balance);
  /// So many iterations of conjugate gradients there.
  void iterate(const FrameShape& shape, double iterations);
  /// Where nothing estimates the error: a correction by the whole inverse, and its stress.
  void check(const FrameShape& shape);

  [[nodiscard]] FrameSum sum() const;

 private:
  const FrameRates& rates_;
  double seconds_ = 0;
  FrameSum apart_;  // but the time
};

struct FrameCost {
  FrameSum quiet;
  FrameSum fracture;  ///< nothing: nothing can be destroyed
};

/// Of conjugate gradients on a device apart, from the last solution to that with an element less.
[[nodiscard]] double iterations_apart(const FrameShape& shape);

[[nodiscard]] FrameCost frame_cost(const FrameShape& shape, const FrameRates& rates);

/// Unknowns with a force or a grip that an instrument brings, at most.
[[nodiscard]] std::size_t loaded_unknowns(const Problem& problem);

/// Frames that follow one another without a pause while another thread makes a factor of the
/// damaged body, checks it and follows them. From sizes alone: what is taken after so many frames
/// must not depend on how long anything took.
[[nodiscard]] int frames_of_a_factor(const linear_algebra::SupernodalCholesky& factor,
                                     std::size_t elements);
/// The same where a frame takes so many seconds.
[[nodiscard]] int frames_of_a_factor(const linear_algebra::SupernodalCholesky& factor,
                                     std::size_t elements, double frame);

/// Whether an event of so many elements is worth a new factor of the body instead of an update.
[[nodiscard]] bool takes_new_factor(std::size_t unknowns, std::size_t elements);

/// In which a thread beside the steps will have made and factored a tangent, the machine busy with
/// them. Likewise from sizes alone.
[[nodiscard]] double seconds_of_a_tangent(const linear_algebra::Supernodes& order,
                                          const Problem& problem);

/// What a step of a body is made of by laws of finite deformation or in motion, on the host.
struct LawCost {
  double back_solve_ms = 0, forces_ms = 0, stress_ms = 0;  ///< of one each
  double tangent_ms = 0;  ///< assembled and factored, beside the steps
  double quiet_ms = 0;    ///< a step of the usual count of back-solves
  double torn_ms = 0;     ///< after a rupture
};

/// `dense`: unknowns of a dense inverse that is the base; 0: the factor is.
[[nodiscard]] LawCost law_cost(const linear_algebra::Supernodes& order, const Problem& problem,
                               std::size_t dense);

}  // namespace sunder::solver
