// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/frame_kernels.hpp"

#include <string>

#include "solver/stress_kernel.hpp"
#include "sunder/words.hpp"

namespace sunder::cpu_reference {
namespace {

std::string values(std::size_t count) { return std::to_string(count) + " values"; }

std::string square(std::size_t n) { return std::to_string(n) + " x " + std::to_string(n); }

class Frame {
 public:
  Frame(const solver::FrameShape& shape, const Needs& needs) : shape_(shape), needs_(needs) {}

  std::vector<KernelPlan> kernels() {
    if (shape_.route == Route::cg) {
      conjugate_gradients();
    } else if (shape_.eager) {
      eager();
    } else {
      deferred();
    }
    fields();
    return std::move(list_);
  }

 private:
  void add(std::string name, std::string does) {
    list_.push_back({std::move(name), std::move(does)});
  }

  void conjugate_gradients() {
    add("product K u", "element by element, " + std::to_string(shape_.elements) + " elements");
    if (shape_.entries == 0) {  // which does not fit the memory
      add("incomplete solve",
          "forward and backward through an incomplete factor of the intact "
          "body, with as many values as the stiffness");
      return;
    }
    add("intact solve", "forward and backward through the intact factor, " +
                            values(2 * shape_.entries) +
                            ": first guess and preconditioner of conjugate gradients");
    if (shape_.grips > 0) hold();
  }

  void eager() {
    add("columns", "u = X f: " + std::to_string(shape_.loaded + shape_.grips) +
                       " loaded columns of the inverse, " + square(shape_.kept));
    if (shape_.grips > 0) hold();
    if (!shape_.damage) return;
    add("low-rank update", "of the inverse, rank 6 for each destroyed element, " +
                               values(shape_.kept * shape_.kept) + " read and written");
  }

  void deferred() {
    const bool factor = shape_.route == Route::factor;
    if (factor) {
      add("forward solve", "of the load along its elimination path, " + values(shape_.load_path));
    } else {
      add("load columns", std::to_string(shape_.loaded + shape_.grips) +
                              " loaded columns of the inverse, " + square(shape_.kept));
    }
    if (shape_.damage) {
      add("small update",
          factor ? "columns of a destroyed element along its elimination path, " +
                       values(shape_.path) + " for one, then the small matrix of the damage"
                 : std::string("entries of the inverse at a destroyed element, then the small "
                               "matrix of the damage"));
    }
    if (shape_.grips > 0) hold();
    if (shape_.damage) add("damage forces", "by the small matrix, refined");
    if (factor) {
      add("backward solve", "of load and damage through the factor, " + values(shape_.entries));
    } else if (shape_.damage) {
      add("damage columns",
          "torn columns of the inverse, " + std::to_string(shape_.kept) + " values each" +
              (shape_.route == Route::inverse ? "; as many as a solve costs: the factor" : ""));
    }
    if (shape_.damage) add("new base", "on a thread beside the frames, as damage gathers");
  }

  void hold() {
    add("grips", "forces that hold " + count_of(static_cast<long long>(shape_.grips), "unknown") +
                     ", by their compliance");
  }

  void fields() {
    if (shape_.stressed > 0) {
      add("stress", std::to_string(solver::StressKernel::kLanes) + " elements at a time on " +
                        std::to_string(shape_.threads) +
                        (shape_.threads == 1 ? " thread, " : " threads, ") +
                        std::to_string(shape_.stressed) + " elements" +
                        (needs_.stress ? "" : ": their norm alone, for the error estimate"));
    }
    if (needs_.yield) add("yield summary", "largest ratio, and where");
    if (needs_.pristine) {
      add("intact body's field",
          (shape_.entries == 0
               ? std::string("conjugate gradients")
               : "forward and backward through the intact factor, " + values(2 * shape_.entries)) +
              ", once a step that breaks");
    }
  }

  const solver::FrameShape& shape_;
  const Needs& needs_;
  std::vector<KernelPlan> list_;
};

}  // namespace

std::vector<KernelPlan> frame_kernels(const solver::FrameShape& shape, const Needs& needs) {
  return Frame(shape, needs).kernels();
}

}  // namespace sunder::cpu_reference
