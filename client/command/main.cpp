// `linetree`: pictures and figures from a server, or from this process (--local).
#include "client/command/command.h"

int main(int argc, char** argv) { return linetree::RunCommandLine(argc, argv); }
