# Writes to OUT the header HEADER with two members of the same size having changed places.
file(READ ${HEADER} text)
string(REGEX REPLACE "double velocity_step;" "double <swapped>;" text "${text}")
string(REGEX REPLACE "double position_step;" "double velocity_step;" text "${text}")
string(REPLACE "double <swapped>;" "double position_step;" text "${text}")
file(WRITE ${OUT}/ilaw/ilaw.h "${text}")
