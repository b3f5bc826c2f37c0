#pragma once
#include <atomic>
#include <map>
#include <string>
#include <string_view>

/// Process-wide counts of constructions and events, by dotted name ("gl.context", "tool.simbody_system").
/// They prove what a scene leaves out: a test asserts that the counter of an unnamed part stays zero.
namespace palpate::counters {

/// The counter of that name; the reference stays valid for the life of the process.  Thread-safe.
std::atomic<long>& counter(std::string_view name);

/// Adds one.  Called in the constructor of whatever a scene may leave out.
inline void count(std::string_view name, long n = 1) { counter(name) += n; }

/// All counters ever named, with their values.
std::map<std::string, long> snapshot();

/// Sets every counter to zero (tests).
void reset();

}  // namespace palpate::counters
