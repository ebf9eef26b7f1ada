// SPDX-License-Identifier: Apache-2.0
#include "gpu/kernel_table.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "shaders/layout.h"

namespace sunder::gpu {
namespace {

using enum Reads;

constexpr KernelRow kTable[] = {
    {"add", "u += du, where a solution is refined", {doubles, plain}, sizeof(std::uint32_t)},
    {"apply",
     "the inverse's columns that carry load, summed in chunks",
     {reals, words, plain},
     sizeof(shaders::ApplyPush)},
    {"cg_begin",
     "residual and first direction of conjugate gradients",
     {plain, words, doubles, plain, plain, plain},
     sizeof(shaders::CgPush)},
    {"cg_check",
     "whether conjugate gradients go on",
     {doubles, doubles, plain, plain},
     sizeof(shaders::CgPush)},
    {"cg_coarse",
     "rigid motions of groups of nodes: their equations solved",
     {doubles, doubles, plain, plain},
     sizeof(shaders::CgPush)},
    {"cg_direction",
     "next direction of conjugate gradients",
     {plain, doubles, doubles, words, doubles, plain},
     sizeof(shaders::CgPush)},
    {"cg_length",
     "length of a step of conjugate gradients",
     {doubles, doubles, plain},
     sizeof(shaders::CgPush)},
    {"cg_multiply", "K p by 3 x 3 blocks", {doubles, plain, words, doubles, plain, plain}, 0},
    {"cg_restrict",
     "rigid motions of groups of nodes: their share of the residual",
     {plain, words, doubles, plain},
     0},
    {"cg_step",
     "step of conjugate gradients, and its preconditioner",
     {plain, doubles, doubles, doubles, doubles, doubles, plain, plain, plain, plain},
     0},
    {"complement",
     "last step of the inversion on the device",
     {doubles, plain},
     sizeof(shaders::ComplementPush)},
    {"dense",
     "dense product with the inverse, to estimate errors and refine",
     {reals, reals, plain},
     sizeof(shaders::ApplyPush)},
    {"display",
     "fields as a host draws them",
     {doubles, reals, plain, plain, plain, plain},
     sizeof(shaders::DisplayPush)},
    {"finite_apply",
     "tangents of all elements times a direction",
     {reals, plain, plain, doubles, plain},
     sizeof(shaders::FiniteCgPush)},
    {"finite_begin",
     "first loop of L-BFGS",
     {plain, plain, plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_blocks",
     "preconditioner of the tangent: 3 x 3 blocks",
     {reals, plain, plain, plain, words, plain, plain},
     sizeof(shaders::FiniteCgPush)},
    {"finite_columns",
     "the base's change by destroyed elements: its columns",
     {plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_end",
     "second loop of L-BFGS",
     {plain, plain, plain, plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_fold",
     "partial sums of a product added up in order",
     {plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_found",
     "direction of a step that conjugate gradients found",
     {plain, words, doubles, doubles, plain},
     sizeof(shaders::FiniteCgPush)},
    {"finite_gather",
     "internal forces at the nodes, and the residual",
     {plain, plain, plain, plain, plain, plain, plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_law",
     "energy, forces and stress of all elements by their laws",
     {plain, plain, plain, plain, plain, plain, plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_move",
     "a step along the direction",
     {plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_multiply",
     "tangent times a direction at the nodes, inertia included",
     {plain, plain, plain, words, plain, doubles, plain, plain},
     sizeof(shaders::FiniteCgPush)},
    {"finite_product",
     "product with the dense inverse of a recent tangent",
     {reals, doubles, plain},
     sizeof(shaders::FinitePush)},
    {"finite_small",
     "the base's change by destroyed elements: the small matrix",
     {plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_sums",
     "what an iteration returns, and a pair of L-BFGS",
     {plain, plain, plain, plain, plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_tangent",
     "tangents of all elements by their laws",
     {plain, plain, plain, plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"finite_turn",
     "the base turned by the nodes' rotations",
     {plain, plain, plain},
     sizeof(shaders::FinitePush)},
    {"gather",
     "values that the host asks for, side by side",
     {plain, plain, plain},
     sizeof(shaders::GatherPush)},
    {"hold",
     "gripped unknowns at exactly what is prescribed",
     {plain, plain, plain},
     sizeof(shaders::HoldPush)},
    {"low_rank",
     "update of the inverse, rank 6 for each destroyed element",
     {reals, reals, plain},
     sizeof(shaders::LowRankPush)},
    {"narrow", "a vector rounded to what the inverse is stored in", {doubles, plain}, 0},
    {"pick",
     "entries of the inverse that an event needs",
     {plain, plain, plain},
     sizeof(shaders::PickPush)},
    {"residual",
     "f - K u by 3 x 3 blocks, reactions of grips",
     {doubles, doubles, plain, words, doubles, plain, plain, plain},
     0},
    {"solve",
     "u from the exact columns that carry load and damage",
     {doubles, doubles, words, plain},
     sizeof(shaders::SolvePush)},
    {"stress",
     "stress of all elements: ratios to yield, and the norm for the error estimate",
     {doubles, words, doubles, words, plain, plain, plain},
     sizeof(shaders::ElementPush)},
    {"sum",
     "chunks of a product added up in order",
     {doubles, words, plain},
     sizeof(shaders::SumPush)},
    {"summary",
     "what a frame returns, from all workgroups' partial results",
     {plain, plain, plain, plain},
     sizeof(shaders::SummaryPush)},
    {"update_vectors",
     "update vectors of destroyed elements through the inverse",
     {reals, plain, doubles, plain},
     sizeof(shaders::VectorsPush)},
};

}  // namespace

std::span<const KernelRow> kernel_table() { return kTable; }

const KernelRow& kernel_row(std::string_view name) {
  const auto* row = std::ranges::find(kTable, name, &KernelRow::name);
  if (row == std::end(kTable)) {
    throw std::logic_error("gpu/kernel_table.cpp has no row for the kernel " + std::string(name));
  }
  return *row;
}

std::string_view without_variant(std::string_view name) {
  for (const std::string_view variant : {"_gpu_", "_lvp_"}) {
    const std::size_t at = name.find(variant);
    if (at != std::string_view::npos) return name.substr(0, at);
  }
  return name;
}

}  // namespace sunder::gpu
