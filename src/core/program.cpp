#include "core/program.h"

#include <sys/auxv.h>

#include <filesystem>

#include "palpate/core/error.h"

namespace palpate {
namespace fs = std::filesystem;

std::string program_path() {
  std::error_code error;
  if (const fs::path here = fs::canonical("/proc/self/exe", error); !error) return here.string();
  const auto* started_by = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  if (const fs::path here = fs::canonical(started_by ? started_by : "", error); !error) return here.string();
  fail("cannot locate the palpate executable: /proc is not mounted, and \"{}\" is not a file: {}",
       started_by ? started_by : "", error.message());
}

std::string temporary_folder() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  if (!error) return folder.string();
  const char* named = std::getenv("TMPDIR");
  fail("{}: cannot be used for temporary files ({}); set TMPDIR to a writable folder", named ? named : "/tmp",
       error.message());
}

}  // namespace palpate
