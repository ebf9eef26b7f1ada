// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "sunder/mesh.hpp"

namespace sunder::test {

/// Equal in everything.
inline void expect_same_mesh(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i)
    ASSERT_EQ(a.nodes[i], b.nodes[i]) << "node " << i;
  ASSERT_EQ(a.tets, b.tets);
  ASSERT_EQ(a.volume_of, b.volume_of);
  ASSERT_EQ(a.volumes.size(), b.volumes.size());
  for (std::size_t v = 0; v < a.volumes.size(); ++v) {
    EXPECT_EQ(a.volumes[v].name, b.volumes[v].name);
    EXPECT_EQ(a.volumes[v].tag, b.volumes[v].tag);
  }
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  for (std::size_t s = 0; s < a.surfaces.size(); ++s) {
    EXPECT_EQ(a.surfaces[s].name, b.surfaces[s].name);
    EXPECT_EQ(a.surfaces[s].triangles, b.surfaces[s].triangles);
  }
}

}  // namespace sunder::test
