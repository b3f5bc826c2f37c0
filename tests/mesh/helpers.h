#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/mesh/source.h"
#include "temporary_folder.h"

/// A temporary folder of one test, in memory where possible, because the fuzz test writes thousands of files.
class TempFolder {
 public:
  void write(const std::string& name, std::string_view text) const { folder_.write(name, text); }
  std::string path() const { return folder_.string(); }

 private:
  static std::filesystem::path place() {
    return access("/dev/shm", W_OK) == 0 ? "/dev/shm" : std::filesystem::temp_directory_path();
  }
  palpate::TemporaryFolder folder_{place()};
};

inline palpate::MeshSpec file_spec(const std::string& name) {
  palpate::MeshSpec spec;
  spec.file = name;
  spec.scale = 1.0;  // as in the file
  return spec;
}

inline palpate::MeshSpec generator_spec(const std::string& name) {
  palpate::MeshSpec spec;
  spec.generator = name;
  return spec;
}

inline bool is_surface_file(const std::string& name) { return name.ends_with(".obj"); }

/// Reads tetrahedra or a surface, depending on the extension.
inline palpate::mesh::MeshReport read_any(const std::string& folder, const std::string& name) {
  palpate::mesh::MeshReport report;
  if (is_surface_file(name))
    palpate::mesh::surface(file_spec(name), folder, &report);
  else
    palpate::mesh::tet_mesh(file_spec(name), folder, &report);
  return report;
}

/// Returns the message of the palpate::Error that `call` throws; other exceptions are not caught.
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
