// The columns of a recording while their units are looked for.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "init/columns/units.h"
#include "init/overflow.h"

namespace axisfit {

/// A column with what a job would say of it.
struct GuessedColumn {
  std::string column;  ///< its name, or its number
  Kind kind = Kind::command;
  bool is_setpoint = false;            ///< see ColumnGuess
  std::string stored;                  ///< the unit, where stored_unit() knows it; else empty
  std::string unit;                    ///< as written in the job, see write_units()
  double factor = 1.0;                 ///< beside the unit, as the job writes it
  bool of_rating = false;              ///< in per cent of a rating, whatever `unit` says
  bool is_duty = false;                ///< a part of a supply
  Overflow overflow{};                 ///< of the stored values
  bool negative = false;               ///< its sign is to be turned
  std::vector<std::string> reasons{};  ///< what was measured, sentences without a full stop
  bool idle = false;                   ///< told by another one, and more precisely
  bool contradicts = false;            ///< another one, by a factor that no unit explains
  bool guessed = false;                ///< something of it neither name nor measurement says
  bool sized_by_range = false;         ///< its unit was guessed, by how large its values are
  double range = 0.0;                  ///< how large they are at most, as stored
  /// In the SI unit of its kind, and of the joint of its unit, at the times of the recording.
  std::vector<double> values{};
  std::string clock{};  ///< column of times of its own; empty: those of the recording
  std::string clock_unit{};
  std::string answer{};  ///< the column as the user called it; empty: nobody asked
  std::string supply{};  ///< column of the voltage that the values of a duty are of; empty: none
  std::string supply_unit{};
  std::size_t hold = 1;       ///< how often each value was recorded
  std::size_t averaged = 1;   ///< samples of which each value is the mean
  bool changes_only = false;  ///< it seems to be recorded where it changes alone

  bool is_constant() const;
  /// As messages call it.
  std::string title() const;
};

/// Whether a word is digits alone.
bool is_number(const std::string& word);

/// Whether all values are equal.
bool never_changes(const std::vector<double>& values);

/// The largest size of a value, either way.
double largest(const std::vector<double>& values);

/// A column while its unit is looked for.
struct UnscaledColumn {
  GuessedColumn column;
  std::string named;           ///< unit in its name; empty: none
  double size = 0.0;           ///< of the unit in SI; zero: not known yet
  std::optional<Joint> joint;  ///< whose motion the unit measures; none: not known
  std::vector<double> raw;     ///< at the times of the recording
  std::string shown;           ///< what messages call it
  int rank = 0;
  bool turns = false;     ///< its name is that of an angle or a torque
  bool answered = false;  ///< by the user

  void set_unit(const StoredUnit& unit);
  /// A size that no unit has.
  void set_size(double any, std::optional<Joint> of);
  void reason(std::string text);
  void guess(std::string text);
};

/// One column at most of each kind, measured and wanted.
class ColumnSet {
 public:
  using Key = std::pair<Kind, bool>;  ///< kind, and whether it is a set value

  UnscaledColumn* find(Kind kind, bool is_setpoint = false);
  UnscaledColumn& operator[](const Key& key) { return columns_[key]; }
  void erase(const Key& key) { columns_.erase(key); }
  auto begin() { return columns_.begin(); }
  auto end() { return columns_.end(); }

 private:
  std::map<Key, UnscaledColumn> columns_;
};

}  // namespace axisfit
