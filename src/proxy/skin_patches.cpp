#include "proxy/skin_patches.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace palpate::proxy {
namespace {

Vec3 face_middle(const TriMesh& skin, int f) {
  return (skin.vertices.col(skin.faces(0, f)) + skin.vertices.col(skin.faces(1, f)) +
          skin.vertices.col(skin.faces(2, f))) /
         3.0;
}

/// Returns the axis along which the points extend farthest.
template <class Item, class Place>
int longest_axis(std::span<const Item> items, Place place) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Item& item : items) {
    low = low.cwiseMin(place(item));
    high = high.cwiseMax(place(item));
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  return axis;
}

/// Partitions items at the median along their longest axis; returns the size of the first half.
/// @param place  position of an item
/// @param rank   tie-breaker of items at one position
template <class Place, class Rank>
std::size_t halve(std::span<int> items, Place place, Rank rank) {
  const int axis = longest_axis(std::span<const int>(items), place);
  const auto half = static_cast<std::ptrdiff_t>(items.size() / 2);
  std::nth_element(items.begin(), items.begin() + half, items.end(), [&](int f, int g) {
    return std::pair(place(f)[axis], rank(f)) < std::pair(place(g)[axis], rank(g));
  });
  return static_cast<std::size_t>(half);
}

/// Returns the rank of each face in an order that depends on its corners only.  A region's patches, and with
/// them its first normal, are then independent of the order in which faces are listed.
std::vector<int> ranks(const Faces& faces) {
  std::vector<int> order(static_cast<std::size_t>(faces.cols())), rank(order.size());
  std::iota(order.begin(), order.end(), 0);
  const auto corners = [&](int f) {
    std::array<int, 3> out = {faces(0, f), faces(1, f), faces(2, f)};
    std::sort(out.begin(), out.end());
    return out;
  };
  std::sort(order.begin(), order.end(),
            [&](int f, int g) { return std::pair(corners(f), f) < std::pair(corners(g), g); });
  for (std::size_t i = 0; i < order.size(); ++i)
    rank[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  return rank;
}

/// Returns a ball around some faces, centred in their box.
Ball ball_of(const TriMesh& skin, std::span<const int> faces) {
  Ball out{Vec3::Zero(), 0.0};
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int f : faces)
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(skin.vertices.col(skin.faces(k, f)));
      high = high.cwiseMax(skin.vertices.col(skin.faces(k, f)));
    }
  out.centre = 0.5 * (low + high);
  for (const int f : faces)
    for (int k = 0; k < 3; ++k)
      out.radius = std::max(out.radius, (skin.vertices.col(skin.faces(k, f)) - out.centre).norm());
  return out;
}

/// Adds the faces [first, first + count) of out.faces as one patch, or recursively as two halves.
void add_faces(const TriMesh& skin, const std::vector<int>& rank, int proxy, std::size_t first,
               std::size_t count, int patch_faces, SkinPatches& out) {
  const std::span<int> faces(out.faces.data() + first, count);
  if (static_cast<int>(count) <= patch_faces) {
    const Ball ball = ball_of(skin, faces);
    SkinPatch patch;
    patch.proxy = proxy;
    patch.first_face = static_cast<int>(first);
    patch.face_count = static_cast<int>(count);
    patch.centre = ball.centre;
    patch.radius = ball.radius;
    for (const int f : faces) {
      const Vec3 a = skin.vertices.col(skin.faces(0, f)), b = skin.vertices.col(skin.faces(1, f)),
                 c = skin.vertices.col(skin.faces(2, f));
      patch.area += 0.5 * (b - a).cross(c - a);
    }
    out.patches.push_back(patch);
  } else {
    const std::size_t half = halve(
        faces, [&](int f) { return face_middle(skin, f); },
        [&](int f) { return rank[static_cast<std::size_t>(f)]; });
    add_faces(skin, rank, proxy, first, half, patch_faces, out);
    add_faces(skin, rank, proxy, first + half, count - half, patch_faces, out);
  }
}

void add_halved(std::vector<ProxyBranch>& tree, std::span<int> proxies, const Points& middle, int parent) {
  const auto branch = tree.size();
  tree.push_back({parent, 0, proxies.size() == 1 ? proxies[0] : -1, Vec3::Zero(), Vec3::Zero()});
  if (proxies.size() > 1) {
    const std::size_t half = halve(
        proxies, [&](int p) -> Vec3 { return middle.col(p); }, [](int p) { return p; });
    add_halved(tree, proxies.first(half), middle, static_cast<int>(branch));
    add_halved(tree, proxies.subspan(half), middle, static_cast<int>(branch));
  }
  tree[branch].after = static_cast<int>(tree.size());
}

/// Adds the bone's proxies and, below them, its child bones; nothing for a bone without any.
void add_bone(std::vector<ProxyBranch>& tree, const Skeleton& skeleton,
              std::vector<std::vector<int>>& of_bone, const Points& middle, int bone, int parent) {
  const auto branch = tree.size();
  tree.push_back({parent, 0, -1, Vec3::Zero(), Vec3::Zero()});
  if (auto& own = of_bone[static_cast<std::size_t>(bone)]; !own.empty())
    add_halved(tree, own, middle, static_cast<int>(branch));
  for (std::size_t child = 0; child < skeleton.bones.size(); ++child)
    if (skeleton.bones[child].parent == bone)
      add_bone(tree, skeleton, of_bone, middle, static_cast<int>(child), static_cast<int>(branch));
  if (tree.size() == branch + 1) return tree.pop_back();
  tree[branch].after = static_cast<int>(tree.size());
}

}  // namespace

SkinPatches skin_patches(const TriMesh& skin, const std::vector<int>& owner_of_face, int proxies,
                         int patch_faces) {
  SkinPatches out;
  const std::vector<int> rank = ranks(skin.faces);
  out.faces.resize(owner_of_face.size());
  std::iota(out.faces.begin(), out.faces.end(), 0);
  const auto key = [&](int f) {
    return std::pair(owner_of_face[static_cast<std::size_t>(f)], rank[static_cast<std::size_t>(f)]);
  };
  std::sort(out.faces.begin(), out.faces.end(), [&](int f, int g) { return key(f) < key(g); });
  std::size_t first = 0;
  for (int p = 0; p < proxies; ++p) {
    out.first_of_proxy.push_back(static_cast<int>(out.patches.size()));
    std::size_t end = first;
    while (end < out.faces.size() && owner_of_face[static_cast<std::size_t>(out.faces[end])] == p) ++end;
    if (end > first) add_faces(skin, rank, p, first, end - first, patch_faces, out);
    first = end;
  }
  out.first_of_proxy.push_back(static_cast<int>(out.patches.size()));
  return out;
}

std::vector<ProxyBranch> proxy_tree(const Skeleton& skeleton, const std::vector<ProxyHull>& proxies,
                                    const Points& middle) {
  std::vector<ProxyBranch> tree;
  std::vector<std::vector<int>> of_bone(skeleton.bones.size());
  std::vector<int> free;
  for (int p = 0; p < static_cast<int>(proxies.size()); ++p)
    (proxies[static_cast<std::size_t>(p)].bone >= 0
         ? of_bone[static_cast<std::size_t>(proxies[static_cast<std::size_t>(p)].bone)]
         : free)
        .push_back(p);
  if (free.size() == proxies.size()) {
    add_halved(tree, free, middle, -1);
    return tree;
  }
  tree.emplace_back();
  if (!free.empty()) add_halved(tree, free, middle, 0);
  for (std::size_t b = 0; b < skeleton.bones.size(); ++b)
    if (skeleton.bones[b].parent < 0) add_bone(tree, skeleton, of_bone, middle, static_cast<int>(b), 0);
  tree[0].after = static_cast<int>(tree.size());
  return tree;
}

void refit(std::vector<ProxyBranch>& tree, const std::vector<Box>& boxes) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (ProxyBranch& branch : tree) {
    branch.low =
        branch.proxy < 0 ? Vec3(Vec3::Constant(infinity)) : boxes[static_cast<std::size_t>(branch.proxy)].low;
    branch.high = branch.proxy < 0 ? Vec3(Vec3::Constant(-infinity))
                                   : boxes[static_cast<std::size_t>(branch.proxy)].high;
  }
  for (std::size_t i = tree.size(); i-- > 1;) {  // preorder: children follow their parent
    ProxyBranch& parent = tree[static_cast<std::size_t>(tree[i].parent)];
    parent.low = parent.low.cwiseMin(tree[i].low);
    parent.high = parent.high.cwiseMax(tree[i].high);
  }
}

}  // namespace palpate::proxy
