#include "session/snapshot_spool.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/bytes.h"
#include "palpate/core/error.h"

namespace palpate::session {
namespace {

void put(ByteWriter& out, const Pose& pose) {
  for (int i = 0; i < 4; ++i) out.put(pose.rotation.coeffs()[i]);
  for (int i = 0; i < 3; ++i) out.put(pose.translation[i]);
}

Pose pose_from(ByteReader& in) {
  Pose out;
  for (int i = 0; i < 4; ++i) out.rotation.coeffs()[i] = in.get<double>();
  for (int i = 0; i < 3; ++i) out.translation[i] = in.get<double>();
  return out;
}

std::string bytes_of(const WorldSnapshot& snapshot) {
  ByteWriter out;
  out.put(snapshot.time).put(snapshot.nodes.size());
  for (const Points& nodes : snapshot.nodes) out.put(VecX(nodes.reshaped()));
  out.put(snapshot.stress.size());
  for (const VecX& stress : snapshot.stress) out.put(stress);
  out.put(snapshot.depths.size());
  for (const auto& depths : snapshot.depths) {
    out.put(depths.size());
    for (const auto& [vertex, depth] : depths) out.put(vertex).put(depth);
  }
  out.put(snapshot.bones.size());
  for (const Pose& bone : snapshot.bones) put(out, bone);
  out.put(snapshot.tools.size());
  for (const Pose& tool : snapshot.tools) put(out, tool);
  out.put(snapshot.handle.has_value());
  if (snapshot.handle) put(out, *snapshot.handle);
  return out.take();
}

WorldSnapshot snapshot_from(const std::string& bytes) {
  ByteReader in(bytes);
  WorldSnapshot out;
  out.time = in.get<double>();
  out.nodes.resize(in.get<std::size_t>());
  for (Points& nodes : out.nodes) {
    const VecX all = in.get<VecX>();
    nodes = all.reshaped(3, all.size() / 3);
  }
  out.stress.resize(in.get<std::size_t>());
  for (VecX& stress : out.stress) stress = in.get<VecX>();
  out.depths.resize(in.get<std::size_t>());
  for (auto& depths : out.depths) {
    depths.resize(in.get<std::size_t>());
    for (auto& [vertex, depth] : depths) vertex = in.get<int>(), depth = in.get<float>();
  }
  out.bones.resize(in.get<std::size_t>());
  for (Pose& bone : out.bones) bone = pose_from(in);
  out.tools.resize(in.get<std::size_t>());
  for (Pose& tool : out.tools) tool = pose_from(in);
  if (in.get<bool>()) out.handle = pose_from(in);
  return out;
}

}  // namespace

SnapshotSpool::SnapshotSpool(const std::string& folder) : folder_(folder) {
  std::string name = (std::filesystem::path(folder) / ".instants-XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) refuse("written");
  unlink(name.c_str());
  file_ = fdopen(descriptor, "w+b");
  if (!file_) refuse("written");
}

SnapshotSpool::~SnapshotSpool() {
  if (file_) std::fclose(file_);
}

void SnapshotSpool::refuse(const char* what) const {
  fail("{}: the positions for pictures cannot be {}: {}", folder_, what, std::strerror(errno));
}

void SnapshotSpool::append(const WorldSnapshot& snapshot) {
  const std::string bytes = bytes_of(snapshot);
  const std::size_t size = bytes.size();
  if (std::fwrite(&size, sizeof size, 1, file_) != 1 || std::fwrite(bytes.data(), 1, size, file_) != size ||
      std::fflush(file_) != 0)
    refuse("written");
  ++count_;
}

void SnapshotSpool::rewind() {
  std::rewind(file_);
  read_ = 0;
}

bool SnapshotSpool::next(WorldSnapshot& out) {
  if (read_ == count_) return false;
  std::size_t size = 0;
  if (std::fread(&size, sizeof size, 1, file_) != 1) refuse("read");
  std::string bytes(size, '\0');
  if (std::fread(bytes.data(), 1, size, file_) != size) refuse("read");
  out = snapshot_from(bytes);
  ++read_;
  return true;
}

}  // namespace palpate::session
