#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/mesh/source.h"

/// A folder of this test's own, gone with it;
/// in memory where that is possible, because the fuzz test writes thousands of files.
class TempFolder {
 public:
  TempFolder() {
    const std::string name = "palpate_mesh_" + std::to_string(getpid());
    std::error_code failed;
    path_ = std::filesystem::path("/dev/shm") / name;
    if (std::filesystem::create_directories(path_, failed); !failed) return;
    path_ = std::filesystem::path(testing::TempDir()) / name;
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  void write(const std::string& name, std::string_view text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

inline palpate::MeshSpec file_spec(const std::string& name) {
  palpate::MeshSpec spec;
  spec.file = name;
  return spec;
}

inline palpate::MeshSpec generator_spec(const std::string& name) {
  palpate::MeshSpec spec;
  spec.generator = name;
  return spec;
}

inline bool is_surface_file(const std::string& name) { return name.ends_with(".obj"); }

/// Reads tetrahedra or a surface, by the ending.
inline palpate::mesh::MeshReport read_any(const std::string& folder, const std::string& name) {
  palpate::mesh::MeshReport report;
  if (is_surface_file(name))
    palpate::mesh::surface(file_spec(name), folder, &report);
  else
    palpate::mesh::tet_mesh(file_spec(name), folder, &report);
  return report;
}

/// The message of the palpate::Error that `call` throws; anything else is not caught.
template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const palpate::Error& e) { return e.what(); }
  return "nothing was refused";
}

inline void expect_contains(const std::string& message, const std::string& fragment) {
  EXPECT_NE(message.find(fragment), std::string::npos) << "\"" << fragment << "\" is not in: " << message;
}
