// Diagnoses a recording of an axis with a tight spot made here, and writes its page: for the test that opens pages.
#include <cstdio>

#include <report/diagnosis_report.hpp>

#include "config/rig_parameters.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/synthetic_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::testing;

int main(int count, char** words) {
  if (count != 2) {
    std::fputs("usage: make_sample_diagnosis FILE.html\n", stderr);
    return 2;
  }
  Rig rig = driven_axis_rig(), machine = rig;
  rig.name = "sample <axis>";
  set_parameter(machine, "effects.friction_zone.force_N", 12);
  set_parameter(machine, "effects.friction_zone.center_m", 0.04);
  set_parameter(machine, "effects.friction_zone.width_m", 0.012);
  write_diagnosis_report(diagnose(rig, {axis_recording(machine, 7, no_extra)}), words[1]);
}
