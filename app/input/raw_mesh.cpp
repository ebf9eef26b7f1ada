// SPDX-License-Identifier: Apache-2.0
#include "app/input/raw_mesh.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace sunder::app {
namespace {

template <class Value>
void put(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  const std::size_t begin = bytes.size();
  bytes.resize(begin + sizeof(Value));
  std::memcpy(bytes.data() + begin, &value, sizeof(Value));
}

template <class Value>
void put(std::string& bytes, const std::vector<Value>& values) {
  put(bytes, std::uint64_t{values.size()});
  const std::size_t begin = bytes.size();
  bytes.resize(begin + values.size() * sizeof(Value));
  if (!values.empty())
    std::memcpy(bytes.data() + begin, values.data(), values.size() * sizeof(Value));
}

void put(std::string& bytes, const std::string& text) {
  put(bytes, std::uint64_t{text.size()});
  bytes += text;
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <class Value>
  bool get(Value& value) {
    if (bytes_.size() < sizeof(Value)) return false;
    std::memcpy(&value, bytes_.data(), sizeof(Value));
    bytes_.remove_prefix(sizeof(Value));
    return true;
  }
  template <class Value>
  bool get(std::vector<Value>& values) {
    std::uint64_t count = 0;
    if (!get(count) || count > bytes_.size() / sizeof(Value)) return false;
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), bytes_.data(), count * sizeof(Value));
    bytes_.remove_prefix(count * sizeof(Value));
    return true;
  }
  bool get(std::string& text) {
    std::uint64_t count = 0;
    if (!get(count) || count > bytes_.size()) return false;
    text.assign(bytes_.substr(0, count));
    bytes_.remove_prefix(count);
    return true;
  }
  [[nodiscard]] bool done() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

bool consistent(const RawMesh& mesh) {
  return mesh.coordinates.size() == 3 * mesh.node_tags.size() &&
         mesh.tet_nodes.size() == 4 * mesh.tet_tags.size() &&
         mesh.tet_group.size() == mesh.tet_tags.size() &&
         mesh.triangle_nodes.size() == 3 * mesh.triangle_tags.size() &&
         mesh.triangle_group.size() == mesh.triangle_tags.size();
}

}  // namespace

std::string to_bytes(const RawMesh& mesh) {
  std::string bytes;
  put(bytes, mesh.node_tags);
  put(bytes, mesh.coordinates);
  put(bytes, mesh.tet_tags);
  put(bytes, mesh.tet_nodes);
  put(bytes, mesh.tet_group);
  put(bytes, mesh.triangle_tags);
  put(bytes, mesh.triangle_nodes);
  put(bytes, mesh.triangle_group);
  put(bytes, std::uint64_t{mesh.groups.size()});
  for (const RawGroup& group : mesh.groups) {
    put(bytes, group.dimension);
    put(bytes, group.tag);
    put(bytes, group.name);
  }
  put(bytes, mesh.curved);
  put(bytes, mesh.other_solids);
  put(bytes, mesh.other_name);
  return bytes;
}

std::optional<RawMesh> from_bytes(std::string_view bytes) {
  Reader reader(bytes);
  RawMesh mesh;
  std::uint64_t groups = 0;
  bool ok = reader.get(mesh.node_tags) && reader.get(mesh.coordinates) &&
            reader.get(mesh.tet_tags) && reader.get(mesh.tet_nodes) && reader.get(mesh.tet_group) &&
            reader.get(mesh.triangle_tags) && reader.get(mesh.triangle_nodes) &&
            reader.get(mesh.triangle_group) && reader.get(groups) && groups <= bytes.size();
  for (std::uint64_t i = 0; ok && i < groups; ++i) {
    RawGroup group;
    ok = reader.get(group.dimension) && reader.get(group.tag) && reader.get(group.name);
    mesh.groups.push_back(std::move(group));
  }
  ok = ok && reader.get(mesh.curved) && reader.get(mesh.other_solids) &&
       reader.get(mesh.other_name) && reader.done() && consistent(mesh);
  if (!ok) return std::nullopt;
  return mesh;
}

void set_groups_in_order(RawMesh& mesh, const std::vector<int>& tags) {
  if (tags.size() != mesh.tet_tags.size()) return;
  std::vector<std::size_t> order(tags.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return mesh.tet_tags[a] < mesh.tet_tags[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) mesh.tet_group[order[i]] = tags[i];
}

}  // namespace sunder::app
