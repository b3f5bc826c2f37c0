#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/core/pose.h"

namespace palpate {

/// Checkpoint of an object: the named values that it needs to resume later from its present state, bitwise.
///
/// One function serves saving and restoring, so that the two cannot differ:
///     void archive(Archive& a) { a("x", x_); a("v", v_); a("axis", axis_); }
/// A saving archive copies the values; a restoring one sets them, and throws Error where a value is missing
/// or has another size or kind.
class Archive {
 public:
  /// Value of one entry: doubles, integers, or bytes.
  using Value = std::variant<std::vector<double>, std::vector<std::int64_t>, std::string>;
  /// Entries by full name, for example "bodies.state.q".
  using Values = std::map<std::string, Value, std::less<>>;

  /// Makes an archive that saves.
  Archive() = default;
  /// Makes an archive that restores.
  /// @param values  entries of an archive that saved
  /// @param where  beginning of error messages: the file
  Archive(Values values, std::string where);
  bool is_restoring() const { return gives_back_; }  ///< Whether it restores; otherwise it saves.
  const Values& values() const { return values_; }   ///< All entries, saved or to be restored.
  /// Checks that every entry was restored.  @throws Error for an entry that no object requested
  void check_all_restored() const;

  /// Scope in which names get a prefix: "limiter.last_time".
  class Group {
   public:
    /// Appends `name` to the prefix of the enclosing groups.
    Group(Archive& archive, std::string_view name) : archive_(archive), before_(archive.prefix_) {
      archive_.prefix_ += name;
      archive_.prefix_ += '.';
    }
    ~Group() { archive_.prefix_ = before_; }
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;

   private:
    Archive& archive_;
    std::string before_;
  };

  /// Archives one value under a name that is unique in its group: a number, boolean, enumeration, text,
  /// list of numbers, matrix, rotation, pose, twist, wrench, or an object that has an archive() function.
  /// @throws Error on restoring, where the value is missing or does not fit
  void operator()(std::string_view name, double& value) { numbers(name, {&value, 1}); }
  void operator()(std::string_view name, std::string& text);          ///< Archives a text.
  void operator()(std::string_view name, std::vector<double>& list);  ///< Archives a list of numbers.
  /// Archives an integer, boolean or enumeration.
  template <class Integer>
  requires(std::integral<Integer> || std::is_enum_v<Integer>) void operator()(std::string_view name,
                                                                              Integer& value) {
    std::int64_t kept = static_cast<std::int64_t>(value);
    integer(name, kept);
    value = static_cast<Integer>(kept);
  }
  /// Archives a matrix; one of dynamic size is resized on restoring.
  template <int Rows, int Columns>
  void operator()(std::string_view name, Eigen::Matrix<double, Rows, Columns>& matrix) {
    if constexpr (Rows == Eigen::Dynamic || Columns == Eigen::Dynamic) {
      const Group group(*this, name);
      Eigen::Index rows = matrix.rows(), columns = matrix.cols();
      (*this)("rows", rows);
      (*this)("columns", columns);
      check_size(name, rows, columns, Rows, Columns);
      matrix.resize(rows, columns);
      numbers("values", {matrix.data(), static_cast<std::size_t>(matrix.size())});
    } else {
      numbers(name, {matrix.data(), static_cast<std::size_t>(matrix.size())});
    }
  }
  /// Archives a rotation.
  void operator()(std::string_view name, Quat& q) { numbers(name, {q.coeffs().data(), 4}); }
  void operator()(std::string_view name, Pose& pose);      ///< Archives a pose.
  void operator()(std::string_view name, Twist& twist);    ///< Archives a twist.
  void operator()(std::string_view name, Wrench& wrench);  ///< Archives a wrench.
  /// Archives an object by its archive() function, in a group called `name`.
  template <class Object>
  requires requires(Object& object, Archive& archive) { object.archive(archive); }
  void operator()(std::string_view name, Object& object) {
    const Group group(*this, name);
    object.archive(*this);
  }
  /// Archives the elements of a sequence whose length is the same on saving and restoring; f(element)
  /// archives one.
  template <class Sequence, class F>
  void each(std::string_view name, Sequence& sequence, F&& f) {
    std::size_t i = 0;
    for (auto& element : sequence) {
      const Group group(*this, std::string(name) + "." + std::to_string(i++));
      f(element);
    }
  }
  /// Archives many small elements as one list of numbers.  visit(f, element) calls f for each member:
  /// numbers, vectors, poses, twists, wrenches.
  template <class Sequence, class Visit>
  void rows(std::string_view name, Sequence& sequence, Visit&& visit) {
    std::vector<double> all;
    std::size_t next = 0;
    const auto number = [&](auto& value) {
      if (!gives_back_)
        all.push_back(static_cast<double>(value));
      else if (next < all.size())
        value = static_cast<std::remove_reference_t<decltype(value)>>(all[next]);
      ++next;
    };
    if (gives_back_) all = given<std::vector<double>>(name);
    for (auto& element : sequence) visit([&](auto& member) { each_number(number, member); }, element);
    if (!gives_back_) return keep(name, std::move(all));
    check_count(name, all.size(), next);
  }
  /// Archives a sequence with its length; restoring resizes it, so the elements must be
  /// default-constructible.
  template <class Sequence, class F>
  void list(std::string_view name, Sequence& sequence, F&& f) {
    std::size_t size = sequence.size();
    (*this)(std::string(name).append(".size"), size);
    check_length(name, static_cast<std::int64_t>(size));
    sequence.resize(size);
    each(name, sequence, f);
  }
  /// Archives numbers whose count is the same on saving and restoring.
  void numbers(std::string_view name, std::span<double> values);
  /// Archives a trivially copyable record as raw bytes: readable only by the same program.
  template <class Record>
  requires std::is_trivially_copyable_v<Record>
  void bytes(std::string_view name, Record& record) {
    raw(name, {reinterpret_cast<char*>(&record), sizeof(Record)});
  }

 private:
  void integer(std::string_view name, std::int64_t& value);
  void raw(std::string_view name, std::span<char> bytes);
  template <class F, class T>
  static void each_number(F&& f, T& member) {
    if constexpr (std::is_arithmetic_v<T>) {
      f(member);
    } else if constexpr (std::is_same_v<T, Pose>) {
      each_number(f, member.rotation.coeffs());
      each_number(f, member.translation);
    } else if constexpr (std::is_same_v<T, Twist>) {
      each_number(f, member.angular);
      each_number(f, member.linear);
    } else if constexpr (std::is_same_v<T, Wrench>) {
      each_number(f, member.moment);
      each_number(f, member.force);
    } else {
      for (Eigen::Index i = 0; i < member.size(); ++i) f(member.data()[i]);
    }
  }
  void check_count(std::string_view name, std::size_t kept, std::size_t requested) const;
  void check_length(std::string_view name, std::int64_t size) const;
  void check_size(std::string_view name, Eigen::Index rows, Eigen::Index columns, int fixed_rows,
                  int fixed_columns) const;
  std::string full(std::string_view name) const { return prefix_ + std::string(name); }
  void keep(std::string_view name, Value value);
  const Value& given_value(std::string_view name);
  template <class T>
  const T& given(std::string_view name) {
    const T* value = std::get_if<T>(&given_value(name));
    if (!value) refuse_kind(name);
    return *value;
  }
  [[noreturn]] void refuse_kind(std::string_view name) const;

  Values values_;
  std::map<std::string, bool, std::less<>> asked_;
  std::string prefix_, where_;
  bool gives_back_ = false;
};

}  // namespace palpate
