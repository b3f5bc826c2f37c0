#include "store/provenance.h"

#include <fmt/chrono.h>
#include <hdf5.h>
#include <sys/utsname.h>

#include <Eigen/Core>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "palpate_commit.h"

namespace palpate::store {
namespace {

std::string cpu_model() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name") && line.find(':') + 2 <= line.size())
      return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

std::string system_name() {
  utsname name{};
  if (uname(&name) != 0) return "unknown";
  return fmt::format("{} {} {}", name.sysname, name.release, name.machine);
}

}  // namespace

std::string version() { return PALPATE_VERSION; }
std::string full_version() { return fmt::format("{} ({})", PALPATE_VERSION, PALPATE_COMMIT); }

Provenance provenance() {
  Provenance out;
  out.version = PALPATE_VERSION;
  out.commit = PALPATE_COMMIT;
#if defined(__clang__)
  out.compiler = "clang " __clang_version__;
#else
  out.compiler = "gcc " __VERSION__;
#endif
  out.build_type = PALPATE_BUILD_TYPE;
  out.libraries = {
      {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
      {"HDF5", hdf5_version()},
      {"nlohmann_json", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                    NLOHMANN_JSON_VERSION_PATCH)}};
  out.cpu = cpu_model();
  out.cores = static_cast<int>(std::thread::hardware_concurrency());
  out.system = system_name();
  out.started_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return out;
}

}  // namespace palpate::store
