#include "plugin_library.h"

#include <dlfcn.h>
#include <link.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "core/printable.h"
#include "palpate/core/error.h"

namespace palpate::device {
namespace {

constexpr const char* kSymbol = "palpate_device_plugin";

/// Returns the path for the loader: the file in the scene's folder, or a name that the loader finds.
std::string loadable_path(const std::string& library, const std::string& folder) {
  const std::filesystem::path path = std::filesystem::absolute(std::filesystem::path(folder) / library);
  if (std::filesystem::is_regular_file(path)) return path.lexically_normal().string();
  if (library.find('/') == std::string::npos) return library;
  fail("device: library = \"{}\" does not exist: there is no file {}; build the driver, or correct the path",
       library, path.lexically_normal().string());
}

/// Returns the range of addresses of a loaded shared object; zeros where it is not known.
std::pair<std::uintptr_t, std::uintptr_t> addresses_of(void* handle) {
  struct Search {
    std::uintptr_t base;
    std::uintptr_t first = 0, last = 0;
  };
  link_map* map = nullptr;
  if (::dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0) return {};
  Search search{static_cast<std::uintptr_t>(map->l_addr)};
  ::dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* data) {
        auto& out = *static_cast<Search*>(data);
        if (info->dlpi_addr != out.base) return 0;
        for (int i = 0; i < info->dlpi_phnum; ++i) {
          const auto& part = info->dlpi_phdr[i];
          if (part.p_type != PT_LOAD || !(part.p_flags & PF_X)) continue;
          out.first = out.base + part.p_vaddr;
          out.last = out.first + part.p_memsz;
        }
        return 1;
      },
      &search);
  return {search.first, search.last};
}

}  // namespace

PluginLibrary::PluginLibrary(const std::string& library, const std::string& options,
                             const std::string& folder)
    : options_(options) {
  const std::string path = loadable_path(library, folder);
  handle_ = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle_) {
    const std::string why = printable(::dlerror());
    if (library.find('/') == std::string::npos && path == library)  // a name that the loader did not find
      fail(
          "device: library = \"{}\" cannot be loaded: it is not in the scene's folder {}, and {}; give an "
          "absolute "
          "path, or one from the scene's folder",
          library, std::filesystem::absolute(folder).lexically_normal().string(), why);
    fail("device: library = \"{}\" cannot be loaded: {}", library, why);
  }
  try {
    table_ = static_cast<const PalpatePlugin*>(::dlsym(handle_, kSymbol));
    if (!table_)
      fail(
          "device: library = \"{}\" exports no \"{}\"; define it by PALPATE_DEVICE_PLUGIN of "
          "palpate/device/plugin.h",
          library, kSymbol);
    check_table(library);
    name_.text = fmt::format("device driver \"{}\"", library);
    std::tie(name_.first, name_.last) = addresses_of(handle_);
    guard_.emplace(name_);
    read_specification(library);
    name_.text = fmt::format("device driver \"{}\" ({})", specification_.name, path);
  } catch (...) {
    guard_.reset();
    ::dlclose(handle_);
    throw;
  }
}

PluginLibrary::~PluginLibrary() {
  guard_.reset();
  ::dlclose(handle_);
}

void PluginLibrary::check_table(const std::string& library) const {
  if (table_->version != PALPATE_PLUGIN_VERSION)
    fail(
        "device: library = \"{}\" has version {} of the driver interface, and this palpate version {}; "
        "build it against the header palpate/device/plugin.h of this palpate",
        library, table_->version, PALPATE_PLUGIN_VERSION);
  const auto check_size = [&](const char* what, std::uint32_t size, std::size_t expected) {
    if (size != expected)
      fail(
          "device: library = \"{}\": {} = {} bytes, but this palpate has {}; build it against the header "
          "palpate/device/plugin.h of this palpate, without options that pack structures",
          library, what, size, expected);
  };
  check_size("table_size", table_->table_size, sizeof(PalpatePlugin));
  check_size("specification_size", table_->specification_size, sizeof(PalpatePluginSpecification));
  check_size("sample_size", table_->sample_size, sizeof(PalpatePluginSample));
  check_size("wrench_size", table_->wrench_size, sizeof(PalpatePluginWrench));
  const auto check_function = [&](const char* what, bool present) {
    if (!present) fail("device: library = \"{}\": the table has no function \"{}\"", library, what);
  };
  check_function("specification", table_->specification);
  check_function("open", table_->open);
  check_function("sample", table_->sample);
  check_function("close", table_->close);
}

void PluginLibrary::read_specification(const std::string& library) {
  PalpatePluginSpecification read = {};
  call("specification", [&] { return table_->specification(options_.c_str(), &read); });
  const std::string name(read.name, ::strnlen(read.name, sizeof read.name));
  if (name.empty() || name.size() == sizeof read.name)
    fail("device: library = \"{}\": its specification has no name of at most {} characters", library,
         sizeof read.name - 1);
  const auto stated = [&](const char* what, double value) -> std::optional<double> {
    if (!std::isfinite(value) || value < 0.0)
      fail(
          "device: library = \"{}\": {} = {} of its specification must be a number of at least 0; 0 states "
          "nothing",
          library, what, value);
    return value > 0.0 ? std::optional(value) : std::nullopt;
  };
  specification_.name = printable(name);
  specification_.max_force = stated("max_force_n", read.max_force_n);
  specification_.max_torque =
      read.max_torque_n_m < 0.0 ? std::optional(0.0) : stated("max_torque_n_m", read.max_torque_n_m);
  specification_.max_stiffness = stated("max_stiffness_n_m", read.max_stiffness_n_m);
  Vec3 extents = Vec3::Zero();
  for (int i = 0; i < 3; ++i) extents[i] = stated("workspace_m", read.workspace_m[i]).value_or(0.0);
  if (extents.minCoeff() > 0.0) specification_.workspace = extents;
  needs_real_time_ = read.real_time != 0;
  has_velocities_ = read.no_velocity == 0;
}

void PluginLibrary::fail_in(const char* function, const std::string& text) const {
  fail("device: {}: {}: {}", name_.text, function, printable(text));
}

}  // namespace palpate::device
