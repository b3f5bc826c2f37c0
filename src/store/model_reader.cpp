#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/sandbox.h"
#include "palpate/core/error.h"
#include "store/h5.h"
#include "store/mesh_file.h"
#include "store/model_file.h"
#include "store/model_format.h"

namespace palpate::store {
namespace {

/// Group of the file; error messages begin with `FILE: "GROUP/NAME"`.
class Group {
 public:
  Group(hid_t file, const char* name, const std::string& path) : name_(name), path_(path) {
    if (H5Lexists(file, name, H5P_DEFAULT) > 0)
      id_ =
          h5::Id{h5::check(H5Gopen2(file, name, H5P_DEFAULT), path, std::string("cannot open group ") + name),
                 H5Gclose};
  }
  explicit operator bool() const { return id_ >= 0; }
  std::string full(const char* name) const { return fmt::format("{}: \"{}/{}\"", path_, name_, name); }

  /// Reads a matrix of `rows` x width; any number of rows where `rows` is negative.
  template <class Matrix>
  Matrix matrix(const char* name, Eigen::Index width, Eigen::Index rows = -1) const {
    constexpr bool real = std::is_same_v<typename Matrix::Scalar, double>;
    const h5::Opened set = h5::open(id_, name, real ? H5T_FLOAT : H5T_INTEGER, 2, path_);
    if (set.shape[1] != static_cast<hsize_t>(width))
      fail("{} is {} x {}, must be n x {}", full(name), set.shape[0], set.shape[1], width);
    Matrix out(width, counted(name, set.shape[0], rows));
    h5::read(set, name, real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT, out.data(), path_);
    if constexpr (real)
      for (Eigen::Index i = 0; i < out.cols(); ++i)
        if (!out.col(i).allFinite()) fail("{}: row {} is not finite", full(name), i);
    return out;
  }
  template <class Scalar>
  std::vector<Scalar> column(const char* name, Eigen::Index rows = -1) const {
    constexpr bool real = std::is_same_v<Scalar, double>;
    const h5::Opened set = h5::open(id_, name, real ? H5T_FLOAT : H5T_INTEGER, 1, path_);
    std::vector<Scalar> out(static_cast<std::size_t>(counted(name, set.shape[0], rows)));
    h5::read(set, name, real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT, out.data(), path_);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (!std::isfinite(static_cast<double>(out[i]))) fail("{}: entry {} is not finite", full(name), i);
    return out;
  }
  std::string text(const char* name) const { return h5::read_text(id_, name, path_); }
  std::vector<std::string> lines(const char* name) const {
    const std::string all = text(name);
    std::vector<std::string> out;
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t end = std::min(all.find('\n', at), all.size());
      out.push_back(all.substr(at, end - at));
      at = end + 1;
    }
    return out;
  }
  /// Reads offsets that divide `total` entries into `parts`.
  std::vector<int> offsets(const char* name, Eigen::Index parts, Eigen::Index total) const {
    const std::vector<int> out = column<int>(name, parts + 1);
    if (out.front() != 0 || out.back() != total || !std::is_sorted(out.begin(), out.end()))
      fail("{} must increase from 0 to {}", full(name), total);
    return out;
  }
  void within(const char* name, int index, int low, Eigen::Index end) const {
    if (index < low || index >= end)
      fail("{} refers to {}, must lie in [{}, {}); indices count from 0", full(name), index, low, end);
  }

 private:
  Eigen::Index counted(const char* name, hsize_t found, Eigen::Index requested) const {
    if (found > static_cast<hsize_t>(std::numeric_limits<int>::max()))
      fail("{} has {} rows, more than {}", full(name), found, std::numeric_limits<int>::max());
    if (requested >= 0 && found != static_cast<hsize_t>(requested))
      fail("{} has {} rows, must have {}", full(name), found, requested);
    return static_cast<Eigen::Index>(found);
  }

  std::string name_, path_;
  h5::Id id_;
};

void read_skin(hid_t file, const std::string& path, LayeredModel& model) {
  const Group skin(file, "skin", path), embedding(file, "embedding", path);
  if (!skin) {
    if (embedding) fail("{}: has an embedding but no skin", path);
    return;
  }
  model.skin.vertices = skin.matrix<Points>("vertices", 3);
  model.skin.faces = skin.matrix<Faces>("faces", 3);
  for (Eigen::Index i = 0; i < model.skin.faces.size(); ++i)
    skin.within("faces", model.skin.faces.data()[i], 0, model.skin.vertices.cols());
  if (!embedding) return;
  model.embedding.tet = embedding.column<int>("tet", model.skin.vertices.cols());
  for (const int tet : model.embedding.tet) embedding.within("tet", tet, 0, model.tets.tets.cols());
  model.embedding.weights =
      embedding.matrix<Eigen::Matrix<double, 4, Eigen::Dynamic>>("weights", 4, model.skin.vertices.cols());
  // A vertex far outside has large weights, so their sum has a larger rounding error.
  for (Eigen::Index i = 0; i < model.embedding.weights.cols(); ++i)
    if (const double sum = model.embedding.weights.col(i).sum();
        std::abs(sum - 1.0) > 1e-9 * (1.0 + model.embedding.weights.col(i).cwiseAbs().sum()))
      fail("{}: row {} sums to {}, must sum to 1", embedding.full("weights"), i, sum);
}

void read_skeleton(hid_t file, const std::string& path, LayeredModel& model) {
  const Group group(file, "skeleton", path);
  if (!group) return;
  const std::vector<std::string> names = group.lines("names");
  const auto count = static_cast<Eigen::Index>(names.size());
  const std::vector<int> parents = group.column<int>("parent", count);
  const Points heads = group.matrix<Points>("head", 3, count), tails = group.matrix<Points>("tail", 3, count);
  const std::vector<double> head_radii = group.column<double>("head_radius", count),
                            tail_radii = group.column<double>("tail_radius", count);
  for (std::size_t b = 0; b < names.size(); ++b) {
    const auto at = static_cast<Eigen::Index>(b);
    group.within("parent", parents[b], -1, at);  // Parents precede their children.
    if (!(head_radii[b] > 0 && tail_radii[b] > 0))
      fail("{}: bone \"{}\" has radii {} and {} m, must be positive", path, names[b], head_radii[b],
           tail_radii[b]);
    model.skeleton.bones.push_back(
        {names[b], parents[b], heads.col(at), tails.col(at), head_radii[b], tail_radii[b]});
  }
  model.bone_of_node = group.column<int>("bone_of_node", model.tets.nodes.cols());
  for (const int bone : model.bone_of_node) group.within("bone_of_node", bone, -1, count);
}

void read_proxies(hid_t file, const std::string& path, LayeredModel& model) {
  constexpr int kLargestHull = 32;
  const Group group(file, "proxies", path);
  if (!group) return;
  const std::vector<int> bones = group.column<int>("bone"), members = group.column<int>("members");
  const auto count = static_cast<Eigen::Index>(bones.size());
  const Points corners = group.matrix<Points>("corners", 3);
  const std::vector<int> of_corners = group.offsets("corner_offsets", count, corners.cols());
  const std::vector<int> of_members =
      group.offsets("member_offsets", count, static_cast<Eigen::Index>(members.size()));
  std::vector<char> held(static_cast<std::size_t>(model.skin.vertices.cols()), 0);
  for (const int vertex : members) {
    group.within("members", vertex, 0, model.skin.vertices.cols());
    held[static_cast<std::size_t>(vertex)] = 1;
  }
  if (const auto lost = std::find(held.begin(), held.end(), 0); lost != held.end())
    fail("{}: skin vertex {} belongs to no proxy", path, lost - held.begin());
  for (std::size_t p = 0; p < bones.size(); ++p) {
    group.within("bone", bones[p], -1, static_cast<Eigen::Index>(model.skeleton.bones.size()));
    ProxyHull proxy;
    const int size = of_corners[p + 1] - of_corners[p];
    if (size < 1 || size > kLargestHull)
      fail("{}: proxy {} has {} corners, must have between 1 and {}", path, p, size, kLargestHull);
    proxy.corners = corners.middleCols(of_corners[p], size);
    proxy.members.assign(members.begin() + of_members[p], members.begin() + of_members[p + 1]);
    if (std::adjacent_find(proxy.members.begin(), proxy.members.end(), std::greater_equal<>()) !=
        proxy.members.end())
      fail("{}: the members of proxy {} must increase strictly", path, p);
    proxy.bone = bones[p];
    model.proxies.push_back(std::move(proxy));
  }
}

std::vector<MaterialRegion> regions_in(hid_t file, const std::string& path, Eigen::Index count_of_tets) {
  const Group group(file, "regions", path);
  if (!group) return {};
  const std::vector<std::string> names = group.lines("names");
  const auto count = static_cast<Eigen::Index>(names.size());
  const std::vector<int> tets = group.column<int>("tets");
  const std::vector<int> offsets = group.offsets("offsets", count, static_cast<Eigen::Index>(tets.size()));
  const std::vector<double> stiffness = group.column<double>("youngs_modulus_factor", count),
                            density = group.column<double>("density_factor", count);
  for (const int tet : tets) group.within("tets", tet, 0, count_of_tets);
  std::vector<MaterialRegion> out;
  for (std::size_t r = 0; r < names.size(); ++r) {
    if (std::count(names.begin(), names.end(), names[r]) > 1)
      fail("{}: \"{}\" is the name of two regions", group.full("names"), names[r]);
    if (!(stiffness[r] > 0 && density[r] > 0))
      fail("{}: region \"{}\" has factors {} and {}, must be positive", path, names[r], stiffness[r],
           density[r]);
    out.push_back(
        {names[r], {tets.begin() + offsets[r], tets.begin() + offsets[r + 1]}, stiffness[r], density[r]});
    if (std::adjacent_find(out.back().tets.begin(), out.back().tets.end(), std::greater_equal<>()) !=
        out.back().tets.end())
      fail("{}: the tetrahedra of region \"{}\" must increase strictly", group.full("tets"), names[r]);
  }
  return out;
}

std::vector<std::array<int, 2>> edges_in(hid_t file, const std::string& path, Eigen::Index nodes) {
  const Group group(file, "refined", path);
  if (!group) return {};
  const Eigen::Matrix2Xi ends = group.matrix<Eigen::Matrix2Xi>("edges", 2);
  if (ends.cols() >= nodes)
    fail("{}: {} midpoints, but the mesh has {} nodes", group.full("edges"), ends.cols(), nodes);
  std::vector<std::array<int, 2>> out;
  for (Eigen::Index i = 0; i < ends.cols(); ++i) {
    const Eigen::Index node = nodes - ends.cols() + i;  // its ends come before it
    for (int k = 0; k < 2; ++k) group.within("edges", ends(k, i), 0, node);
    out.push_back({ends(0, i), ends(1, i)});
  }
  return out;
}

ModelRecord read_record(hid_t file, const std::string& path) {
  const Group group(file, "made", path);
  if (!group) return {};
  ModelRecord record{group.text("source"),  group.text("source_hash"), group.text("options"),
                     group.text("version"), group.lines("notes"),      {}};
  const std::vector<std::string> names = group.lines("figure_names");
  const std::vector<double> values = group.column<double>("figures", static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) record.figures.emplace_back(names[i], values[i]);
  return record;
}

ModelFile model_in(const std::string& path) {
  ModelFile out;
  out.model.tets = read_mesh(path);
  if (!is_model(path))
    fail(
        "{}: contains only tetrahedra, not a model: its format is not \"{}\"; `palpate model {} -o FILE.h5` "
        "converts it",
        path, kModelFormat, path);
  const h5::Quiet quiet;
  const h5::Id file = h5::open_file(path);
  out.model.name = h5::read_attribute_text(file, "name", path);
  read_skin(file, path, out.model);
  read_skeleton(file, path, out.model);
  read_proxies(file, path, out.model);
  out.model.regions = regions_in(file, path, out.model.tets.tets.cols());
  out.edges = edges_in(file, path, out.model.tets.nodes.cols());
  out.record = read_record(file, path);
  return out;
}

}  // namespace

ModelFile read_model(const std::string& path) {
  return rehearsed(path, "HDF5", [&] { return model_in(path); });
}

std::vector<MaterialRegion> read_regions(const std::string& path, int tets) {
  return rehearsed(path, "HDF5", [&]() -> std::vector<MaterialRegion> {
    if (!is_model(path)) return {};
    const h5::Quiet quiet;
    return regions_in(h5::open_file(path), path, tets);
  });
}

std::vector<std::array<int, 2>> read_edges(const std::string& path, int nodes) {
  return rehearsed(path, "HDF5", [&]() -> std::vector<std::array<int, 2>> {
    if (!is_model(path)) return {};
    const h5::Quiet quiet;
    return edges_in(h5::open_file(path), path, nodes);
  });
}

}  // namespace palpate::store
