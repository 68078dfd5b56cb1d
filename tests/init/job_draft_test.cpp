#include "init/job_draft.h"

#include <gtest/gtest.h>

#include <string>

namespace axisfit {
namespace {

GuessedColumn column(Kind kind, bool is_setpoint = false) {
  GuessedColumn c;
  c.kind = kind;
  c.is_setpoint = is_setpoint;
  c.values = {1.0, 2.0, -3.0};
  return c;
}

TEST(JobDraft, KindsOfColumnsAreSignals) {
  EXPECT_EQ(signal_of(Kind::current), Signal::motor_current);
  EXPECT_EQ(signal_of(Kind::force), Signal::drive_force);
  EXPECT_EQ(signal_of(Kind::position), Signal::position);
  EXPECT_EQ(signal_of(Kind::load_position), Signal::load_position);
  EXPECT_FALSE(signal_of(Kind::supply));
  EXPECT_FALSE(signal_of(Kind::command));
  EXPECT_FALSE(signal_of(Kind::time));
}

TEST(JobDraft, WhatIsMeasuredIsComparedUnlessItDrives) {
  JobDraft draft;
  draft.structure = {Drive::force_source, Transmission::rigid, {}, Joint::prismatic};
  EXPECT_TRUE(draft.is_measured(column(Kind::velocity)));
  EXPECT_FALSE(draft.is_measured(column(Kind::velocity, true))) << "it was asked for";
  EXPECT_FALSE(draft.is_measured(column(Kind::force))) << "it drives";
  EXPECT_FALSE(draft.is_measured(column(Kind::motor_voltage))) << "the axis has none";
  GuessedColumn idle = column(Kind::velocity), constant = idle;
  idle.idle = true;
  constant.values = {2.0, 2.0, 2.0};
  EXPECT_FALSE(draft.is_measured(idle));
  EXPECT_FALSE(draft.is_measured(constant));
  draft.structure = {Drive::velocity_loop, Transmission::backlash, {}, Joint::prismatic};
  EXPECT_TRUE(draft.is_measured(column(Kind::force)));
  EXPECT_TRUE(draft.is_measured(column(Kind::motor_voltage)));
}

TEST(JobDraft, AnInputIsMeasuredOrCommanded) {
  DraftRecording recording;
  recording.guess.columns = {column(Kind::current), column(Kind::current, true),
                             column(Kind::force)};
  recording.input = InputColumn{"command", Kind::current, false, 2.0};
  EXPECT_TRUE(recording.has_measured_input());
  EXPECT_EQ(recording.driving(), (std::vector<double>{2.0, 4.0, -6.0}));
  EXPECT_FALSE(recording.drives_in_newtons());
  recording.input = InputColumn{"command", Kind::current, true};
  EXPECT_FALSE(recording.has_measured_input());
  recording.input = InputColumn{"drive_force", Kind::force};
  EXPECT_TRUE(recording.has_measured_input());
  EXPECT_TRUE(recording.drives_in_newtons());
}

TEST(JobDraft, PathsAreRelativeWhereThatIsShort) {
  JobDraft draft;
  draft.request.folder = "/data/machine/results";
  EXPECT_EQ(draft.relative("/data/machine/results/a.csv"), "a.csv");
  EXPECT_EQ(draft.relative("/data/machine/raw/a.csv"), "../raw/a.csv");
  EXPECT_EQ(draft.relative("/data/a.csv"), "../../a.csv");
  EXPECT_EQ(draft.relative("/other/a.csv"), "/other/a.csv");
}

TEST(JobDraft, SpeaksTheWordsOfItsJoint) {
  JobDraft draft;
  draft.structure = {Drive::motor_current, Transmission::rigid, {}, Joint::revolute};
  EXPECT_EQ(draft.say("force"), "torque");
  EXPECT_EQ(draft.command_unit(), "A");
  EXPECT_EQ(draft.quantity("M").name, "J");
}

}  // namespace
}  // namespace axisfit
