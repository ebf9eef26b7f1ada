// SPDX-License-Identifier: Apache-2.0
// The kernels that passes are made of, one by one, against plain double precision on equal inputs:
// what they must move stays to the bit, what they sum lies within bounds derived entry by entry,
// and what they must not read is no number. Those of route cg: cg_kernels_test.cpp.
#include <algorithm>
#include <numeric>

#include "gpu/passes/gather.hpp"
#include "kernels_fixture.hpp"

namespace sunder::test {
namespace {

class SingleKernels : public Kernels {
 protected:
  using Matrix = Eigen::MatrixXd;
  static constexpr std::uint32_t kRows = 2 * shaders::kRowPad, kPacks = kRows / 4;

  [[nodiscard]] Words shuffled(std::uint32_t count) {
    Words order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), generator_);
    return order;
  }
  /// In storage precision.
  [[nodiscard]] vulkan::Buffer stored(const Matrix& m) const {
    const Doubles values(m.data(), m.data() + m.size());
    return GetParam().fp64 ? buffer(values) : buffer(Floats(values.begin(), values.end()));
  }
  [[nodiscard]] Matrix read_stored(const vulkan::Buffer& from, Index rows, Index columns) const {
    const auto count = static_cast<std::size_t>(rows * columns);
    if (GetParam().fp64) return Eigen::Map<const Matrix>(read(from, count).data(), rows, columns);
    const Floats values = read<float>(from, count);
    return Eigen::Map<const Eigen::MatrixXf>(values.data(), rows, columns).cast<double>();
  }
  [[nodiscard]] Matrix random_matrix(Index rows, Index columns) {
    Matrix m(rows, columns);
    for (double& v : m.reshaped()) v = random();
    return m;
  }
  /// A symmetric matrix of n unknowns as the device has it, tiles over the diagonal no numbers.
  [[nodiscard]] Matrix lower_tiles(const Matrix& symmetric, Index columns) const {
    Matrix m = Matrix::Zero(shaders::kRowPad, columns);
    const auto n = symmetric.rows();
    m.topLeftCorner(n, n) = symmetric;
    for (Index c = 0; c < columns; ++c) {
      for (Index r = 0; r < tile(c) * kTile; ++r) m(r, c) = kNaN;
    }
    return m;
  }
  static constexpr Index kTile = shaders::kTile;
  [[nodiscard]] static Index tile(Index i) { return i / kTile; }
  /// The positions of unknowns among the nodes' values, and those values before.
  struct Nodal {
    Words positions;
    Doubles before;
  };
  [[nodiscard]] Nodal nodal() {
    Words order = shuffled(kRows + 88);
    order.resize(kRows);
    return {order, random_values(kRows + 88)};
  }
  /// What no unknown lies at stays to the bit.
  static void expect_untouched(const Nodal& of, const Doubles& after) {
    std::vector<std::uint8_t> written(of.before.size(), 0);
    for (std::uint32_t at : of.positions) written[at] = 1;
    for (std::size_t i = 0; i < after.size(); ++i) {
      if (!written[i]) {
        EXPECT_EQ(after[i], of.before[i]) << i;
      }
    }
  }
};

TEST_P(SingleKernels, GatherPicksBitForBit) {
  const Doubles values = random_values(500);
  const auto of_values = buffer(values);
  gpu::Gather gather(*factory_, of_values);
  for (const std::uint32_t count : {1u, 64u, 111u, 3u}) {
    Words places = shuffled(500);
    places.resize(count);
    Doubles picked(count + 1, 7);
    gather.read(places, picked);
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(picked[i], values[places[i]]);
    EXPECT_EQ(picked[count], 7);
  }
}

TEST_P(SingleKernels, HoldSetsGrippedDofsAlone) {
  constexpr std::uint32_t kHolds = 70;
  Words held = shuffled(400);
  held.resize(kHolds);
  const Doubles prescribed = random_values(kHolds), before = random_values(400);
  const auto of_held = buffer(held);
  const auto of_prescribed = buffer(prescribed);
  const auto kernel = factory_->make_fp64("hold");
  for (const std::uint32_t to_zero : {0u, 1u}) {
    const auto u = buffer(before);
    run(*kernel, {&of_held, &of_prescribed, &u}, shaders::HoldPush{kHolds, to_zero}, 2);
    Doubles expected = before;
    for (std::size_t i = 0; i < kHolds; ++i) {
      expected[held[i]] = to_zero == 1 ? 0.0 : prescribed[i];
    }
    EXPECT_EQ(read(u, 400), expected);
  }
}

TEST_P(SingleKernels, SumOfChunksGoesToTheNodes) {
  constexpr std::uint32_t kChunks = 5;
  const Nodal u = nodal();
  Doubles partial = random_values(kRows * kChunks);
  partial.resize(kRows * (kChunks + 1), kNaN);
  const auto of_partial = buffer(partial);
  const auto of_positions = buffer(u.positions);
  const auto kernel = factory_->make_fp64("sum");
  for (const std::uint32_t add : {0u, 1u}) {
    const auto of_u = buffer(u.before);
    run(*kernel, {&of_partial, &of_positions, &of_u}, shaders::SumPush{kPacks, kChunks, add},
        kRows / shaders::kRowPad);
    const Doubles got = read(of_u, u.before.size());
    expect_untouched(u, got);
    for (std::size_t i = 0; i < kRows; ++i) {
      double sum = 0, size = 0;
      const auto take = [&](double v) {
        sum += v;
        size += std::abs(v);
      };
      for (std::size_t c = 0; c < kChunks; ++c) take(partial[c * kRows + i]);
      if (add == 1) take(u.before[u.positions[i]]);
      EXPECT_LE(std::abs(got[u.positions[i]] - sum), kChunks * kEps64 * size) << i;
    }
  }
}

TEST_P(SingleKernels, SolveSumsColumnsAtTheNodes) {
  constexpr std::uint32_t kColumns = 9, kRead = 12;  // four at a time
  const Nodal u = nodal();
  Matrix columns = random_matrix(kRows, kRead + 4);
  columns.middleCols(kColumns, kRead - kColumns).setZero();
  columns.rightCols(4).setConstant(kNaN);
  Doubles c = random_values(kRead);
  const auto of_columns = buffer(Doubles(columns.data(), columns.data() + columns.size()));
  const auto of_c = buffer(c), of_u = buffer(u.before);
  const auto of_positions = buffer(u.positions);
  run(*factory_->make_fp64("solve"), {&of_columns, &of_c, &of_positions, &of_u},
      shaders::SolvePush{kPacks, kRead}, kRows / shaders::kRowPad);
  const Doubles got = read(of_u, u.before.size());
  expect_untouched(u, got);
  const Eigen::Map<const Eigen::VectorXd> coefficients(c.data(), kColumns);
  const Eigen::VectorXd expected = columns.leftCols(kColumns) * coefficients;
  const Eigen::VectorXd size = columns.leftCols(kColumns).cwiseAbs() * coefficients.cwiseAbs();
  for (Index i = 0; i < static_cast<Index>(kRows); ++i) {
    EXPECT_LE(std::abs(got[u.positions[static_cast<std::size_t>(i)]] - expected[i]),
              (kColumns + 1) * kEps64 * size[i])
        << i;
  }
}

TEST_P(SingleKernels, NarrowRoundsToANeighbour) {
  const Doubles values = [&] {
    Doubles v(kRows);
    for (double& x : v) x = std::ldexp(uniform_(generator_), static_cast<int>(generator_() % 60));
    v[0] = 0;
    v[1] = 1 + kEps32 / 2;  // half way
    return v;
  }();
  const auto of_values = buffer(values);
  const auto narrow = buffer(Floats(kRows, 7));
  run(*factory_->make_fp64("narrow"), {&of_values, &narrow}, kRows / shaders::kRowPad);
  const Floats got = read<float>(narrow, kRows);
  for (std::size_t i = 0; i < kRows; ++i) {
    EXPECT_LE(std::abs(static_cast<double>(got[i]) - values[i]), kEps32 * std::abs(values[i]));
  }
}

TEST_P(SingleKernels, AddIsExact) {
  constexpr std::uint32_t kAdded = 90;  // packs, no multiple of a workgroup
  const Doubles du = random_values(4 * 128), before = random_values(4 * 128);
  const auto of_du = buffer(du), u = buffer(before);
  run(*factory_->make_fp64("add"), {&of_du, &u}, kAdded, 2);
  Doubles expected = before;
  for (std::size_t i = 0; i < std::size_t{4} * kAdded; ++i) expected[i] += du[i];
  EXPECT_EQ(read(u, expected.size()), expected);
}

TEST_P(SingleKernels, DisplayIsTheFieldsInFp32) {
  constexpr std::uint32_t kNodes = 70, kElements = 130, kPadded = 192;
  const Doubles u = random_values(4 * 128);
  const Matrix stress = random_matrix(8, kPadded);
  std::vector<shaders::ElementFacts> facts(kPadded);
  for (auto& fact : facts) fact.state = generator_() % 8;
  const auto of_u = buffer(u), of_stress = stored(stress);
  const auto of_facts = buffer(facts);
  const auto kernel = factory_->make("display");
  for (const std::uint32_t has_stress : {1u, 0u}) {
    const auto shown = buffer(Floats(4 * 128, 7)), colour = buffer(Floats(2 * kPadded, 7));
    const auto live = buffer(Words(kPadded, 7));
    run(*kernel, {&of_u, &of_stress, &of_facts, &shown, &colour, &live},
        shaders::DisplayPush{kNodes, kElements, has_stress}, 3);
    const Floats at = read<float>(shown, 4 * 128), in = read<float>(colour, 2 * kPadded);
    const Words lives = read<std::uint32_t>(live, kPadded);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double expected = i >= 4 * kNodes ? 7 : i % 4 == 3 ? 0 : u[i];
      EXPECT_LE(std::abs(static_cast<double>(at[i]) - expected), kEps32 * std::abs(expected)) << i;
    }
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double here = stress(6 + static_cast<Index>(i % 2), static_cast<Index>(i / 2));
      const double expected = i >= 2 * kElements ? 7 : has_stress == 0 ? 0 : here;
      EXPECT_LE(std::abs(static_cast<double>(in[i]) - expected), kEps32 * std::abs(expected)) << i;
    }
    for (std::size_t e = 0; e < kPadded; ++e) {
      const std::uint32_t alive = (facts[e].state & shaders::kDestroyed) == 0 ? 1 : 0;
      EXPECT_EQ(lives[e], e < kElements ? alive : 7) << e;
    }
  }
}

TEST_P(SingleKernels, SummaryOfPartialResults) {
  constexpr std::uint32_t kElementParts = 150, kNodeParts = 70;  // no multiples of a workgroup
  std::vector<shaders::StressPartial> elements(kElementParts + 1);
  std::vector<shaders::NodePartial> nodes(kNodeParts + 1);
  for (std::uint32_t i = 0; i < kElementParts; ++i) {
    const double ratio = std::abs(random());
    elements[i] = {ratio, ratio / 2, std::abs(random()), 1000 - i, 2000 + i, i, 1000 - i,
                   i % 2, 0.5f};
  }
  // The same ratio twice: the lower element; and a part that has none.
  elements[77] = {3, 0, 5, 600, shaders::kHeld, 7000, 0, 1, 2.5f};
  elements[140] = {3, 2, 0, 555, 900, 0, 8000, 0, 1.5f};
  elements[141] = {0, 2, 0, shaders::kHeld, 800, 0, 0, 1, 0};
  elements[kElementParts] = {9, 9, 9, 1, 1, 9000, 9000, 9, 9};  // behind the last
  for (auto& n : nodes) n = {std::abs(random()), std::abs(random()), std::abs(random()), 0};
  nodes[kNodeParts] = {1e9, 1e9, 1e9, 0};
  const auto of_elements = buffer(elements);
  const auto of_nodes = buffer(nodes);
  const auto over = buffer(Words(8, 5));
  const auto summaries = empty(20);
  const auto kernel = factory_->make_fp64("summary");
  const auto summary = [&](std::uint32_t node_parts, std::uint32_t slot) {
    run(*kernel, {&of_elements, &of_nodes, &summaries, &over},
        shaders::SummaryPush{kElementParts, node_parts, slot}, 1);
    return read<shaders::Summary>(summaries, 2)[slot];
  };
  const auto expect_worst = [](const shaders::Summary& s) {
    EXPECT_EQ(s.any_ratio, 3);
    EXPECT_EQ(s.any_element, 555u);
    EXPECT_EQ(s.candidate_ratio, 2);
    EXPECT_EQ(s.candidate_element, 800u);
    EXPECT_EQ(s.stress_squared, 5);
    EXPECT_EQ(s.strain, 7000u);
    EXPECT_EQ(s.half_tangent, 8000u);
    EXPECT_EQ(s.inverted, kElementParts / 2);
    EXPECT_EQ(s.handed_out, 2.5f);
  };
  const shaders::Summary second = summary(0, 1);
  expect_worst(second);
  EXPECT_EQ(second.residual_squared, 0);
  EXPECT_EQ(second.reaction_squared, 0);
  EXPECT_EQ(second.largest_u, 0);
  EXPECT_EQ(second.over, 5u);
  const shaders::Summary first = summary(kNodeParts, 0);
  expect_worst(first);
  EXPECT_EQ(first.over, 5u);
  double residual = 0, reaction = 0, largest = 0;
  for (std::size_t i = 0; i < kNodeParts; ++i) {
    residual += nodes[i].residual_squared;
    reaction += nodes[i].reaction_squared;
    largest = std::max(largest, nodes[i].largest_u);
  }
  EXPECT_NEAR(first.residual_squared, residual, kNodeParts * kEps64 * residual);
  EXPECT_NEAR(first.reaction_squared, reaction, kNodeParts * kEps64 * reaction);
  EXPECT_EQ(first.largest_u, largest);
  EXPECT_EQ(summary(0, 0).over, 0u) << "the next frame's list begins anew";
  EXPECT_EQ(read<std::uint32_t>(over, 8), (Words{0, 5, 5, 5, 5, 5, 5, 5}));
}

TEST_P(SingleKernels, ComplementMirrorsTheLowerTiles) {
  constexpr Index kUnknowns = 150, kColumns = 192, kSplit = 128;
  Doubles scales(shaders::kRowPad, 0.0);
  for (std::size_t i = 0; i < kUnknowns; ++i) scales[i] = std::exp2(static_cast<double>(i % 5) - 2);
  const auto diagonal = buffer(scales);
  const Matrix b = random_symmetric(kUnknowns);
  const Matrix swept = lower_tiles(b, kColumns);
  const auto kernel = factory_->make("complement");
  for (const auto& [panels, mirror] : {std::pair{false, false}, {true, false}, {true, true}}) {
    const auto x = stored(Matrix::Constant(shaders::kRowPad, kColumns, kNaN));
    for (const Index first : panels ? std::vector<Index>{0, kSplit} : std::vector<Index>{0}) {
      const Index count = !panels ? kColumns : first == 0 ? kSplit : kColumns - kSplit;
      const Matrix panel = swept.middleCols(first, count);
      const auto of_panel = buffer(Doubles(panel.data(), panel.data() + panel.size()));
      run(*kernel, {&of_panel, &diagonal, &x},
          shaders::ComplementPush{shaders::kRowPad / 4, static_cast<std::uint32_t>(first),
                                  static_cast<std::uint32_t>(count), 0, 0, mirror ? 1u : 0u},
          1, kColumns);
    }
    const Matrix got = read_stored(x, shaders::kRowPad, kColumns);
    const double units = GetParam().eps() + 2 * kEps64;  // rounded to storage, after two steps
    for (Index c = 0; c < kColumns; ++c) {
      for (Index r = 0; r < kColumns; ++r) {
        const bool inside = r < kUnknowns && c < kUnknowns;
        const double scale =
            scales[static_cast<std::size_t>(r)] * scales[static_cast<std::size_t>(c)];
        const double one = r == c && !mirror ? 1 : 0;
        const double expected = inside ? scale * (mirror ? b(r, c) : one - b(r, c)) : 0;
        const double size = inside ? scale * (one + std::abs(b(r, c))) : 0;
        if (r >= kUnknowns && r == c) continue;  // nobody reads a row of padding
        ASSERT_LE(std::abs(got(r, c) - expected), units * size) << r << ", " << c;
      }
    }
  }
}

TEST_P(SingleKernels, UpdateVectorsOfAWholeMatrixAndOfLowerTiles) {
  constexpr Index kUnknowns = 170, kColumns = 192, kRank = 12;
  constexpr std::uint32_t kBlocks = 2, kPacksHere = shaders::kRowPad / 4;
  const Matrix x = random_symmetric(kUnknowns);
  Matrix whole = Matrix::Zero(shaders::kRowPad, kColumns);
  whole.topLeftCorner(kUnknowns, kUnknowns) = x;
  const Words dofs = {169, 2, 63, 64, 100, 128};
  const auto t = static_cast<Index>(dofs.size());
  const Matrix v = random_matrix(t, kRank);
  Doubles packed(static_cast<std::size_t>(t) * kBlocks * 8, 0.0);
  for (Index i = 0; i < t; ++i) {
    for (Index k = 0; k < kRank; ++k)
      packed[static_cast<std::size_t>((i * kBlocks + k / 6) * 8 + k % 6)] = v(i, k);
  }
  const auto of_dofs = buffer(dofs);
  const auto of_v = buffer(packed);
  const std::vector<Index> at(dofs.begin(), dofs.end());
  const Matrix columns = x(Eigen::all, at);
  for (const std::uint32_t lower : {0u, 1u}) {
    const auto kernel = factory_->make("update_vectors", shaders::kGroup, lower);
    const auto of_x = stored(lower == 1 ? lower_tiles(x, kColumns) : whole);
    Matrix expected = columns * v, size = columns.cwiseAbs() * v.cwiseAbs();
    const auto z = stored(Matrix::Constant(shaders::kRowPad, kRank, kNaN));
    for (const std::uint32_t add : {0u, 1u}) {
      const shaders::VectorsPush push{kPacksHere, 0,  static_cast<std::uint32_t>(t), kBlocks, 0,
                                      kColumns,   add};
      run(*kernel, {&of_x, &of_dofs, &of_v, &z}, push, 1, kBlocks);
      // Fp64 sums of t products, rounded to storage; twice where they are added.
      const double units = (add + 1.0) * (static_cast<double>(t) * kEps64 + GetParam().eps());
      const Matrix error =
          (read_stored(z, shaders::kRowPad, kRank).topRows(kUnknowns) - (add + 1.0) * expected)
              .cwiseAbs();
      EXPECT_TRUE((error.array() <= units * size.array()).all())
          << (lower == 1 ? "lower tiles, " : "whole, ") << add;
    }
  }
}

TEST_P(SingleKernels, LowRankUpdateLeavesUpperTilesAlone) {
  constexpr Index kColumns = 192, kSplit = 128, kRows1 = shaders::kRowPad;
  const Matrix x = random_matrix(kRows1, kColumns);
  for (const std::uint32_t blocks : {1u, 3u}) {
    const std::uint32_t rank = blocks * shaders::kRankBlock, one = blocks == 1 ? 1 : 0;
    const Matrix z = random_matrix(kRows1, rank);
    const auto of_z = stored(z);
    const auto kernel = factory_->make("low_rank", factory_->low_rank_group(), one);
    for (const bool panels : {false, true}) {
      for (const float sign : {1.0F, -1.0F}) {
        for (const Index first : panels ? std::vector<Index>{0, kSplit} : std::vector<Index>{0}) {
          const Index count = !panels ? kColumns : first == 0 ? kSplit : kColumns - kSplit;
          const auto of_x = stored(x.middleCols(first, count));
          const auto tiles = static_cast<std::uint32_t>((kColumns - first) / kTile);
          const auto wide = static_cast<std::uint32_t>(count / kTile);
          const shaders::LowRankPush push{kRows1 / 4, blocks, static_cast<std::uint32_t>(first),
                                          tiles, sign};
          run(*kernel, {&of_x, &of_z, &of_x}, push,
              (wide * tiles - wide * (wide - 1) / 2) *
                  (shaders::kTile / factory_->low_rank_columns(one == 1)));
          const Matrix got = read_stored(of_x, kRows1, count);
          for (Index c = 0; c < count; ++c) {
            for (Index r = 0; r < kRows1; ++r) {
              const double before = x(r, first + c);
              if (tile(r) < tile(first + c) || r >= kColumns) {
                ASSERT_EQ(got(r, c), before) << r << ", " << first + c;
                continue;
              }
              const double sum = z.row(r).dot(z.row(first + c));
              const double size = z.row(r).cwiseAbs().dot(z.row(first + c).cwiseAbs());
              ASSERT_LE(std::abs(got(r, c) - (before + static_cast<double>(sign) * sum)),
                        (rank + 1) * GetParam().eps() * (std::abs(before) + size))
                  << r << ", " << first + c;
            }
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SingleKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, false},
                                         Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::lvp, false},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
