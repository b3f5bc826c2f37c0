#pragma once
#include <functional>
#include <string>

/// Sandboxed reading of files through third-party libraries.  HDF5, CGAL and Gmsh trust their input: damaged
/// files make them read out of bounds or request all of the machine's memory.  Therefore a child process
/// reads such a file first; where the child dies, this process rejects the file and survives.
namespace palpate {

/// Calls `read` in a child process (fork; this process is not changed), and returns if it succeeded.  The
/// child has bounded CPU time and memory, and prints nothing.  No effect inside another rehearsal.
/// @param path     file that is read, for messages
/// @param library  library that reads it: "HDF5"
/// @throws Error with the message of the Error that `read` threw in the child, or with the cause of the
///   child's death
void sandboxed_read(const std::string& path, const char* library, const std::function<void()>& read);

/// Calls `read` after its rehearsal in a child process, and returns its result.
template <class Read>
auto rehearsed(const std::string& path, const char* library, const Read& read) {
  sandboxed_read(path, library, [&] { read(); });
  return read();
}

/// Scope in which nothing is rehearsed, for tests of a reader's errors.
class NoSandbox {
 public:
  NoSandbox();
  ~NoSandbox();
  NoSandbox(const NoSandbox&) = delete;
  NoSandbox& operator=(const NoSandbox&) = delete;
};

}  // namespace palpate
