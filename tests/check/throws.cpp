// Throws, which C cannot do.
extern "C" void throw_something() { throw 1; }
