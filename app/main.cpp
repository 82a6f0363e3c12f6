#include "app/commands/program.h"

int main(int argc, char** argv) {
  using namespace fettle::app;
  return runProgram(argc, argv, [](Command root, Chosen& chosen) {
    addScanCommands(root, chosen);
    addPlan(root, chosen);
    addGather(root, chosen);
    addStatus(root, chosen);
    addSubmit(root, chosen);
    addRecord(root, chosen);
    addDevices(root, chosen);
    addView(root, chosen);
    addAccuracy(root, chosen);
    addDemo(root, chosen);
    addBench(root, chosen);
    addReference(root, chosen);
  });
}
