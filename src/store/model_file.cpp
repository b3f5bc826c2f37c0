#include "store/model_file.h"

#include "core/sandbox.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/h5.h"
#include "store/model_format.h"

namespace palpate::store {
namespace {

/// Model file under construction, in memory.
struct ModelWriter {
  std::string path;

  template <class Matrix>
  void matrix(hid_t parent, const char* name, const Matrix& m) const {
    const hid_t type = std::is_same_v<typename Matrix::Scalar, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT;
    h5::write(parent, name, type, {static_cast<hsize_t>(m.cols()), static_cast<hsize_t>(m.rows())}, m.data(),
              path);
  }
  void column(hid_t parent, const char* name, const std::vector<int>& values) const {
    h5::write(parent, name, H5T_NATIVE_INT, {values.size()}, values.data(), path);
  }
  void column(hid_t parent, const char* name, const std::vector<double>& values) const {
    h5::write(parent, name, H5T_NATIVE_DOUBLE, {values.size()}, values.data(), path);
  }
  void text(hid_t parent, const char* name, const std::string& value) const {
    h5::write_text(parent, name, value, path);
  }
  void lines(hid_t parent, const char* name, const std::vector<std::string>& values) const {
    std::string joined;
    for (const std::string& value : values) {
      PALPATE_CHECK(value.find('\n') == std::string::npos, "{} holds \"{}\"", name, value);
      joined += value + "\n";
    }
    text(parent, name, joined);
  }
  h5::Id group(hid_t parent, const char* name) const { return h5::create_group(parent, name, path); }
};

void write_skin(const ModelWriter& to, hid_t file, const LayeredModel& model) {
  if (model.skin.vertices.cols() == 0) return;
  const h5::Id skin = to.group(file, "skin"), embedding = to.group(file, "embedding");
  to.matrix(skin, "vertices", model.skin.vertices);
  to.matrix(skin, "faces", model.skin.faces);
  to.column(embedding, "tet", model.embedding.tet);
  to.matrix(embedding, "weights", model.embedding.weights);
}

void write_proxies(const ModelWriter& to, hid_t file, const std::vector<ProxyHull>& proxies) {
  if (proxies.empty()) return;
  std::vector<int> corner_offsets{0}, member_offsets{0}, members, bones;
  for (const ProxyHull& proxy : proxies) {
    corner_offsets.push_back(corner_offsets.back() + static_cast<int>(proxy.corners.cols()));
    members.insert(members.end(), proxy.members.begin(), proxy.members.end());
    member_offsets.push_back(static_cast<int>(members.size()));
    bones.push_back(proxy.bone);
  }
  Points corners(3, corner_offsets.back());
  for (std::size_t p = 0; p < proxies.size(); ++p)
    corners.middleCols(corner_offsets[p], proxies[p].corners.cols()) = proxies[p].corners;
  const h5::Id group = to.group(file, "proxies");
  to.matrix(group, "corners", corners);
  to.column(group, "corner_offsets", corner_offsets);
  to.column(group, "members", members);
  to.column(group, "member_offsets", member_offsets);
  to.column(group, "bone", bones);
}

void write_skeleton(const ModelWriter& to, hid_t file, const LayeredModel& model) {
  const std::vector<Bone>& bones = model.skeleton.bones;
  if (bones.empty()) return;
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<double> head_radii, tail_radii;
  Points heads(3, static_cast<Eigen::Index>(bones.size())), tails = heads;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    names.push_back(bones[b].name);
    parents.push_back(bones[b].parent);
    heads.col(static_cast<Eigen::Index>(b)) = bones[b].head;
    tails.col(static_cast<Eigen::Index>(b)) = bones[b].tail;
    head_radii.push_back(bones[b].head_radius);
    tail_radii.push_back(bones[b].tail_radius);
  }
  const h5::Id group = to.group(file, "skeleton");
  to.lines(group, "names", names);
  to.column(group, "parent", parents);
  to.matrix(group, "head", heads);
  to.matrix(group, "tail", tails);
  to.column(group, "head_radius", head_radii);
  to.column(group, "tail_radius", tail_radii);
  to.column(group, "bone_of_node", model.bone_of_node);
}

void write_regions(const ModelWriter& to, hid_t file, const std::vector<MaterialRegion>& regions) {
  if (regions.empty()) return;
  std::vector<std::string> names;
  std::vector<int> tets, offsets{0};
  std::vector<double> stiffness, density;
  for (const MaterialRegion& region : regions) {
    names.push_back(region.name);
    tets.insert(tets.end(), region.tets.begin(), region.tets.end());
    offsets.push_back(static_cast<int>(tets.size()));
    stiffness.push_back(region.youngs_modulus_factor);
    density.push_back(region.density_factor);
  }
  const h5::Id group = to.group(file, "regions");
  to.lines(group, "names", names);
  to.column(group, "tets", tets);
  to.column(group, "offsets", offsets);
  to.column(group, "youngs_modulus_factor", stiffness);
  to.column(group, "density_factor", density);
}

void write_edges(const ModelWriter& to, hid_t file, const std::vector<std::array<int, 2>>& edges) {
  if (edges.empty()) return;
  Eigen::Matrix2Xi ends(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i)
    ends.col(static_cast<Eigen::Index>(i)) << edges[i][0], edges[i][1];
  to.matrix(to.group(file, "refined"), "edges", ends);
}

void write_record(const ModelWriter& to, hid_t file, const ModelRecord& record) {
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& [name, value] : record.figures) {
    names.push_back(name);
    values.push_back(value);
  }
  const h5::Id group = to.group(file, "made");
  to.text(group, "source", record.source);
  to.text(group, "source_hash", record.source_hash);
  to.text(group, "options", record.options);
  to.text(group, "version", record.version);
  to.lines(group, "notes", record.notes);
  to.lines(group, "figure_names", names);
  to.column(group, "figures", values);
}

}  // namespace

void write_model(const std::string& path, const ModelFile& file) {
  const LayeredModel& model = file.model;
  const h5::Quiet quiet;
  const ModelWriter to{path};
  const h5::Id root = h5::create_in_memory(path);
  h5::write_attribute_text(root, "format", kModelFormat, path);
  h5::write_attribute_text(root, "name", model.name, path);
  to.matrix(root, "nodes", model.tets.nodes);
  to.matrix(root, "tets", model.tets.tets);
  write_skin(to, root, model);
  write_proxies(to, root, model.proxies);
  write_skeleton(to, root, model);
  write_regions(to, root, model.regions);
  write_edges(to, root, file.edges);
  write_record(to, root, file.record);
  write_atomically(path, h5::image(root, path));
}

bool is_model(const std::string& path) {
  return rehearsed(path, "HDF5", [&] {
    const h5::Quiet quiet;
    const h5::Id file = h5::open_file(path);
    return H5Aexists(file, "format") > 0 && h5::read_attribute_text(file, "format", path) == kModelFormat;
  });
}

}  // namespace palpate::store
