// The program without its picture: every command of the haptic half, through the very main() of the whole.
// For sanitizers that must see all code of a process.
#include "app/commands/program.h"

int main(int argc, char** argv) {
  using namespace fettle::app;
  return runProgram(argc, argv, [](Command root, Chosen& chosen) {
    addReplay(root, chosen);
    addRecord(root, chosen);
    addDevices(root, chosen);
  });
}
