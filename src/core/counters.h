#pragma once
#include <atomic>
#include <map>
#include <string>
#include <string_view>

/// Process-wide counts of constructions and events, by dotted name ("gl.context", "tool.simbody_system").
/// They prove that unused parts are absent: tests assert that the counter of a part that the scene does not
/// specify stays zero.
namespace palpate::counters {

/// Returns the counter of that name; the reference stays valid for the life of the process.  Thread-safe.
std::atomic<long>& counter(std::string_view name);

/// Adds n.  Called in the constructor of every optional part.
inline void count(std::string_view name, long n = 1) { counter(name) += n; }

/// Returns all counters used so far, with their values.
std::map<std::string, long> snapshot();

/// Sets every counter to zero (for tests).
void reset();

}  // namespace palpate::counters
