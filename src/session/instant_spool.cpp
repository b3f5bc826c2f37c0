#include "session/instant_spool.h"

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

std::string bytes_of(const Instant& instant) {
  ByteWriter out;
  out.put(instant.time).put(instant.nodes.size());
  for (const Points& nodes : instant.nodes) out.put(VecX(nodes.reshaped()));
  out.put(instant.stress.size());
  for (const VecX& stress : instant.stress) out.put(stress);
  out.put(instant.depths.size());
  for (const auto& depths : instant.depths) {
    out.put(depths.size());
    for (const auto& [vertex, depth] : depths) out.put(vertex).put(depth);
  }
  out.put(instant.bones.size());
  for (const Pose& bone : instant.bones) put(out, bone);
  out.put(instant.tools.size());
  for (const Pose& tool : instant.tools) put(out, tool);
  out.put(instant.handle.has_value());
  if (instant.handle) put(out, *instant.handle);
  return out.take();
}

Instant instant_from(const std::string& bytes) {
  ByteReader in(bytes);
  Instant out;
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

InstantSpool::InstantSpool(const std::string& folder) : folder_(folder) {
  std::string name = (std::filesystem::path(folder) / ".instants-XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) refuse("written");
  unlink(name.c_str());
  file_ = fdopen(descriptor, "w+b");
  if (!file_) refuse("written");
}

InstantSpool::~InstantSpool() {
  if (file_) std::fclose(file_);
}

void InstantSpool::refuse(const char* what) const {
  fail("{}: the positions for pictures cannot be {}: {}", folder_, what, std::strerror(errno));
}

void InstantSpool::append(const Instant& instant) {
  const std::string bytes = bytes_of(instant);
  const std::size_t size = bytes.size();
  if (std::fwrite(&size, sizeof size, 1, file_) != 1 || std::fwrite(bytes.data(), 1, size, file_) != size ||
      std::fflush(file_) != 0)
    refuse("written");
  ++count_;
}

void InstantSpool::rewind() {
  std::rewind(file_);
  read_ = 0;
}

bool InstantSpool::next(Instant& out) {
  if (read_ == count_) return false;
  std::size_t size = 0;
  if (std::fread(&size, sizeof size, 1, file_) != 1) refuse("read");
  std::string bytes(size, '\0');
  if (std::fread(bytes.data(), 1, size, file_) != size) refuse("read");
  out = instant_from(bytes);
  ++read_;
  return true;
}

}  // namespace palpate::session
