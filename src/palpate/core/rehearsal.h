#pragma once
#include <functional>
#include <string>

/// Files that a library of others reads.  HDF5, CGAL and Gmsh trust the bytes that they are given: damaged
/// ones make them read beyond their memory, or ask for all of the machine's.  So a child process reads such a
/// file first.  Where it dies, this process refuses the file, and lives.
namespace palpate {

/// Calls `read` in a child process (fork; it changes nothing here), and returns where that went well.  The
/// child has a bounded processor time, and prints nothing.  Inside another rehearsal, it does nothing.
/// @param path     of the file, for messages
/// @param library  that reads it: "HDF5"
/// @throws Error with the message of the Error that `read` threw in the child, or one that says how it died
void rehearse(const std::string& path, const char* library, const std::function<void()>& read);

/// `read` after its rehearsal.
template <class Read>
auto rehearsed(const std::string& path, const char* library, const Read& read) {
  rehearse(path, library, [&] { read(); });
  return read();
}

/// While one lives, nothing is rehearsed: for tests that want to see a reader's own faults.
class WithoutRehearsal {
 public:
  WithoutRehearsal();
  ~WithoutRehearsal();
  WithoutRehearsal(const WithoutRehearsal&) = delete;
  WithoutRehearsal& operator=(const WithoutRehearsal&) = delete;
};

}  // namespace palpate
