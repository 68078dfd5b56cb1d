#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// A voltage that the drive adds to its command: the offset of an amplifier.
template <class T>
struct CommandOffset {
  static constexpr std::string_view name = "command_offset";
  static constexpr std::string_view meaning = "offset of the command";
  static constexpr ActsOn acts_on = ActsOn::drive;
  static constexpr std::string_view excitation = "a zero command for a while, besides motion";

  T U_0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"U_0", kCommandUnit, "offset of the command", -1e3, 1e3}.typically(0.05),
          self.U_0);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    // The offset of a force source is a constant force by another name: no recording decides.
    return {{.strengths = {"U_0"}, .used_by = UsedBy::electric_drive}};
  }

  void add_to(Slots<T>& slots) const { slots.command_offset += U_0; }
};

}  // namespace axisfit
