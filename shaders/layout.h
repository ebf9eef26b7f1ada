// SPDX-License-Identifier: Apache-2.0
// Structs and numbers that C++ and GLSL share: read by both, so that a layout exists once.
// Buffers are std430; every matrix is stored by columns, rows padded to kRowPad.
#ifndef SUNDER_SHADERS_LAYOUT_H
#define SUNDER_SHADERS_LAYOUT_H

#ifdef __cplusplus
#include <cstdint>
namespace sunder::shaders {
using uint = std::uint32_t;
#define SUNDER_CONST constexpr uint
#else
#define SUNDER_CONST const uint
#endif

SUNDER_CONST kGroup = 64u;  // invocations of a workgroup
SUNDER_CONST kClosingGroup =
    256u;                          // at most, of one that leaves the one sum of all others' results
SUNDER_CONST kRowPad = 256u;       // rows of a vector: four an invocation
SUNDER_CONST kColumnPad = 64u;     // columns of a matrix
SUNDER_CONST kChunk = 64u;         // columns that one workgroup sums
SUNDER_CONST kRankBlock = 6u;      // update vectors of one element
SUNDER_CONST kTile = 64u;          // edge of the tiles that the low-rank update works on
SUNDER_CONST kLowerTiles = 1u;     // those on and under the diagonal
SUNDER_CONST kUpperTiles = 2u;     // those over it
SUNDER_CONST kUpdateColumns = 8u;  // columns of the inverse that one invocation updates at once
SUNDER_CONST kDamageRows = 16u;    // of the small matrices, a workgroup
SUNDER_CONST kDepth = 8u;          // rows of both factors that a product takes at once
SUNDER_CONST kUpdateTurns = 2u;    // so often, where lavapipe updates with rank 6
SUNDER_CONST kPartsAtOnce = 256u;  // partial results that one of many workgroups joins
SUNDER_CONST kRateUnrolled = 8u;   // multiply-adds in a row, where a device's rates are measured
SUNDER_CONST kHeld = 0xffffffffu;  // dof of an axis that a support holds

// State of an element, bit by bit.
SUNDER_CONST kDestroyed = 1u;
SUNDER_CONST kBreakable = 2u;
SUNDER_CONST kExcluded = 4u;  // never a candidate
SUNDER_CONST kAbsent = 8u;    // padding
SUNDER_CONST kCutOff = 16u;   // of a piece that nothing holds: its deformation does not count

// What the stress pass leaves behind beside its partial results.
SUNDER_CONST kKeepStress = 1u;  // the stress of every element
SUNDER_CONST kListOver = 2u;    // the list of elements at or over yield
SUNDER_CONST kShown = 4u;       // none: displacement and stress are shown in fp32, which counts

// What an element is and does, beside its shape.
struct ElementFacts {
  uint state;
  uint patch_number;           // of pooled volume, from 1; 0: its volume is its own
  uint yield_low, yield_high;  // [MPa], fp64, in two words; 0: unbreakable
};

// One loaded dof: coefficient times a column of the inverse.
struct Entry {
  uint column;
  uint unused;
  uint low, high;  // the coefficient, fp64, in two words
};

struct ApplyPush {
  uint packs;         // rows / 4
  uint first, last;   // entries, or (dense) columns of this matrix
  uint vector_first;  // dense: where the columns' coefficients begin in the vector, / 4
  uint partial;       // first chunk of partial sums
  uint first_column;  // of this panel
  uint columns;       // of this panel
  uint add;           // 1: to the partial sums that are there (kLower alone)
};

struct SumPush {
  uint packs;
  uint chunks;
  uint add;  // 1: add to what is there
};

struct RatePush {
  uint invocations;
  uint reads;  // packs of four values, of each invocation
  uint turns;  // of kRateUnrolled multiply-adds of a pack
};

struct HoldPush {
  uint count;
  uint to_zero;
};

struct GatherPush {
  uint count;
};

// Of a patch of pooled volume.
struct PatchPressure {
  double pressure;  // kappa times its change of volume [MPa]
  double rounding;  // what that may be off by, times 2^24
};

struct ElementPush {
  float alpha, alpha_low;  // its sum has 48 bits
  uint keep;               // kKeepStress, kListOver
  uint measure;            // 0: (s1 - s3)/2, 1: s1 - s3, 2: s1, as YieldMeasure
};

struct DisplayPush {
  uint nodes, elements;
  uint stress;  // 1: it is there
};

// A surface that a host draws (gpu/passes/surface_writer.cpp). Of an element: which of its faces
// show, by the corner opposite, and kGone.
SUNDER_CONST kGone = 16u;
SUNDER_CONST kTriangleWords = 7u;  // of a change: place, three nodes, element, piece, opened
SUNDER_CONST kElementWords = 6u;   // element, what shows of it, four corners
SUNDER_CONST kNodeWords = 2u;      // node, the one of the mesh that it lies at undeformed

// All offsets and strides of a host's buffers are in words of four bytes; a stride of 0: not
// wanted.
struct SurfaceChangesPush {
  uint triangles, elements, nodes;  // how many have changed; in that order in the list
  uint triangles_at, triangles_stride;
  uint facts_at, facts_stride;
  uint values;  // 1: the elements of triangles are kept, for surface_values
};

// Of nodes: places and normals; of a fine mesh: places and lives.
struct SurfacePointsPush {
  uint count;
  uint places_at, places_stride;
  uint others_at, others_stride;
};

// Where stress of an element is from: none, the stress pass, or the host.
SUNDER_CONST kNoStress = 0u;
SUNDER_CONST kOfDevice = 1u;
SUNDER_CONST kOfHost = 2u;

// Of triangles: four numbers each.
struct SurfaceValuesPush {
  uint count;
  uint values_at, values_stride;
  uint stress;
  uint measure;  // as in ElementPush
  uint finite;   // 1: strain is that of U - I
};

struct SummaryPush {
  uint element_parts;  // partial results of the stress pass
  uint node_parts;     // of the residual pass; 0: none
  uint slot;
};

struct SolvePush {
  uint packs;
  uint columns;
};

// Of the small matrices of damage, all stored by columns of so many rows.
struct DamagePush {
  uint columns, grips;
  uint rows;
  uint energies;  // where those of this refinement begin among what is found
};

struct DamageFollowPush {
  uint columns, grips;
  uint rows;
  uint first;             // column of S that is new, and those after it
  uint first_compliance;  // the same of G
  uint rank;
  uint vectors;   // where those of this event begin
  uint subtract;  // 1: the product is taken away
};

struct PickPush {
  uint rows, columns;  // of the block
  uint first_column;   // of this panel
  uint panel_columns;
  uint leading;  // rows of the matrix
};

struct VectorsPush {
  uint packs;
  uint first, last;   // rows of V
  uint blocks;        // rank / 6
  uint first_column;  // of this panel
  uint columns;       // of this panel
  uint add;
};

struct LowRankPush {
  uint packs;
  uint blocks;
  uint first_column;  // of this panel
  uint tiles;         // rows of tiles from this panel's first on
  float sign;         // 1 or -1
};

struct ComplementPush {
  uint packs;
  uint first_column, columns;  // of the panel that is read
  uint to;                     // first column of the panel that is written
  uint left_out;               // kLowerTiles, kUpperTiles, or 0
  uint mirror;                 // 1: X = S B S
};

struct ProductPush {
  uint packs;         // rows / 4
  uint depth;         // rows of both factors, a multiple of kDepth
  uint right_packs;   // of a row of the right factor
  uint right_first;   // its column for the panel's first one
  uint first_column;  // of the panel, in the matrix
  uint column;        // of the panel, where this dispatch begins
  float keep;         // of what was there; 0: nothing, which then is not looked at
  uint lower;         // 1: tiles over the diagonal are left out
};

struct CgPush {
  uint groups;        // workgroups of 64 nodes
  uint partials;      // partial sums / 4
  uint rigid_groups;  // of the second level: groups of nodes
  uint rigid_solves;  // of the dense level: workgroups of four unknowns
  uint first;         // 1: nothing has been iterated yet
  uint guess;         // the first step goes along: 0 nothing, 1 u, 2 a solution that is known
  double reduction;   // stop at this share of the first r^T M r, or of u's energy
  uint elements;      // workgroups of 64 elements or patches, where a kernel goes over these
  uint known;         // which of those
  uint rigid_terms;   // of y^T w of the second level: whole packs of four
  uint rigid_aggregates, rigid_rows;  // of the third level: aggregates, workgroups of 64 groups
  uint unused;
};

SUNDER_CONST kBlockPacks = 5u;  // of a 3 x 3 block of the stiffness, in packs of four words

// Kinds of dispatches: nodes, groups of nodes, unknowns of the dense level, one workgroup, elements
// or patches, aggregates of groups, 64 groups.
SUNDER_CONST kCgByNode = 0u;
SUNDER_CONST kCgByGroup = 1u;
SUNDER_CONST kCgBySolve = 2u;
SUNDER_CONST kCgByOne = 3u;
SUNDER_CONST kCgByElement = 4u;
SUNDER_CONST kCgByAggregate = 5u;
SUNDER_CONST kCgByRow = 6u;
SUNDER_CONST kCgSizes = 7u;
SUNDER_CONST kSixWords = 40u;  // of a 6 x 6 block between groups, in fp32, and its column

// State of conjugate gradients, on the device from the first iteration to the last.
struct CgState {
  double rz;  // r^T M r
  double target;
  double length_;  // of the step along p
  double ratio;    // r^T M r by the one before
  double energy;   // u^T K u of the free unknowns, of the first guess
  uint iterations;
  uint broken;  // 1: p^T K p was not positive, or something was not finite
  uint running;
  uint unused;
};

// Bodies at finite deformation and in motion (gpu/finite_device.cpp).

SUNDER_CONST kFinitePairs = 8u;   // of L-BFGS, at most
SUNDER_CONST kFiniteShape = 12u;  // doubles of an element: grad N_1, N_2, N_3, V, mu, lambda
// Of an element's fibres: of two families direction, k1, k2, dispersion; lambda, alpha, beta and mu
// of law linear.
SUNDER_CONST kFiniteFibres = 16u;
SUNDER_CONST kFiniteTangent = 12u;  // packs of four: the upper triangle of 9 x 9

// Of an element: bits of what it is, and above them its law.
SUNDER_CONST kFiniteOut = 1u;
SUNDER_CONST kFiniteLayer = 2u;  // of an interface: its stress is Biot's, without viscous forces
SUNDER_CONST kFiniteFibrous = 4u;
SUNDER_CONST kFinitePooled = 8u;  // its volume is its patch's
// Times the law: linear, corotated, neo-Hookean, Saint Venant-Kirchhoff.
SUNDER_CONST kFiniteLaw = 16u;
SUNDER_CONST kFiniteLaws = 4u;
SUNDER_CONST kFinitePatch = 64u;  // times the patch

// Of an unknown.
SUNDER_CONST kFiniteGripped = 1u;
SUNDER_CONST kFiniteFrozen = 2u;

struct FinitePush {
  double part;     // of a step
  double viscous;  // factor of viscous forces; 0: none
  uint elements, entries, unknowns;
  uint element_parts, entry_parts;
  uint biot;   // 1: Biot's stress, else Cauchy's
  uint pairs;  // of L-BFGS
  uint slot;   // of the step and the change of the gradient that are written
  uint order;  // slots of the pairs, four bits each, the oldest lowest
  uint rank, turned, back;
  uint shares;   // of the sums: a workgroup each
  uint patches;  // of pooled volume
  uint unused;
};

// Of a patch of pooled volume with its live elements.
struct FinitePatch {
  double pressure;  // U'(J) [MPa]
  double energy;    // V U(J) [N mm], which its first live element adds to its own
  uint first, unused;
};

struct FiniteCgPush {
  uint elements, nodes, unknowns;
};

struct FiniteElementPartial {
  double energy, viscous;
  double stress_squared, change_squared;  // largest Frobenius norms of live elements
};

struct FiniteEntryPartial {
  double residual_squared, held_squared, inertia_squared;
  double springs;  // their energy less the work of the load
};

// What an iteration tells the host.
struct FiniteSums {
  double energy, viscous, springs;
  double residual_squared, held_squared, inertia_squared;
  double stress_squared, change_squared;
  double slope, s_y, s_squared, y_squared;
};

// WIDE: fp64, or fp32 on a device that has no more.
#ifdef __cplusplus
#define SUNDER_WIDE_STRUCT(name) \
  template <class WIDE>          \
  struct name##Of
#else
#define SUNDER_WIDE_STRUCT(name) struct name
#endif

// Worst yield ratio, largest stress and deformation of the elements of one workgroup.
SUNDER_WIDE_STRUCT(StressPartial) {
  WIDE any_ratio, candidate_ratio;
  WIDE stress_squared;  // largest Frobenius norm of a live element, squared
  uint any_element, candidate_element;
  uint strain;        // largest in magnitude: a float's bits, the lowest one its sign
  uint half_tangent;  // tan(theta/2) of the largest rotation: a float's bits
  uint inverted;      // how many
  float handed_out;  // largest bound of what rounding costs a live element's stress, by 2^-24 [MPa]
};

// Sums over the nodes of one workgroup, and their largest displacement.
SUNDER_WIDE_STRUCT(NodePartial) {
  WIDE residual_squared;  // over dofs that no grip holds
  WIDE reaction_squared;  // over those that one holds
  WIDE largest_u;         // in magnitude
  WIDE unused;
};

// All that a frame sends back by itself: 80 bytes.
SUNDER_WIDE_STRUCT(Summary) {
  WIDE any_ratio, candidate_ratio;
  WIDE stress_squared;    // infinite when a stress is no number
  WIDE residual_squared;  // of the nodes' partial sums
  WIDE reaction_squared;
  WIDE largest_u;
  uint any_element, candidate_element;
  uint over;                            // live breakable elements at or over yield
  uint strain, half_tangent, inverted;  // as above
  float handed_out;
};

#ifdef __cplusplus
using StressPartial = StressPartialOf<double>;
using NodePartial = NodePartialOf<double>;
using Summary = SummaryOf<double>;
static_assert(sizeof(SummaryOf<float>) == 52);
static_assert(sizeof(Entry) == 16);
static_assert(sizeof(ElementPush) == 16);
static_assert(sizeof(PatchPressure) == 16);
static_assert(sizeof(StressPartial) == 48);
static_assert(sizeof(NodePartial) == 32);
static_assert(sizeof(ElementFacts) == 16);
static_assert(sizeof(Summary) == 80);
static_assert(sizeof(CgPush) == 56);
static_assert(sizeof(ComplementPush) == 24);
static_assert(sizeof(ProductPush) == 32);
static_assert(sizeof(CgState) == 56);
static_assert(sizeof(FinitePush) == 80);
static_assert(sizeof(FinitePatch) == 24);
static_assert(sizeof(FiniteSums) == 96);
#undef SUNDER_CONST
#undef SUNDER_WIDE_STRUCT
}  // namespace sunder::shaders
#endif
#endif
