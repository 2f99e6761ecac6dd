C abaqus_stub.f - calls VFRIC as the manual says, for points that slide on a plane: predicts the slip without
C friction, gives the force that would stop it, applies the force that comes back.
C SPDX-License-Identifier: BSD-3-Clause
      module abaqus_stub
      use, intrinsic :: iso_c_binding
      implicit none
      character(512) :: last_error = ' '
      contains

C     An increment of n points. mass, load (along the plane) and pressing (normal force) of each; normal of the
C     plane; v is changed, and f is the friction in the axes of the host.
      subroutine stub_increment(interaction, length, nDir, n, time, dt,
     1  mass, load, pressing, normal, v, nProps, constants, nState,
     2  state, f) bind(c)
      include 'vaba_param.inc'
      character(kind=c_char) interaction(length)
      integer(c_int), value :: length, nDir, n, nProps, nState
      real(c_double), value :: time, dt
      real(c_double) mass(n), load(nDir,n), pressing(n), normal(nDir)
      real(c_double) v(nDir,n), constants(nProps), state(nState,n)
      real(c_double) f(nDir,n), predicted(nDir), across(3), speed
      dimension fTangential(nDir-1,n), statev(nState,n), slip(nDir,n)
      dimension stick(n), before(nDir,n), forceN(n), shape(1,n)
      dimension coordSlv(nDir,n), coordMst(nDir,1), tangent(nDir,n)
      dimension dirN(nDir,n), props(nProps), area(n), temp(n)
      dimension preDef(n,1), tempMst(1), preDefMst(1,1)
      integer jSlv(n), jMst(1), jCon(n), jFacet(1,n), k
      character*80 surfInt

      surfInt = ' '
      do k = 1, length
        surfInt(k:k) = interaction(k)
      end do
C     Contact points are the nodes in another order.
      do k = 1, n
        jCon(k) = n + 1 - k
        jSlv(k) = 100 + k
      end do
      do k = 1, n
        predicted = v(:,jCon(k)) + dt/mass(jCon(k))*load(:,jCon(k))
        speed = norm2(predicted)
        if (speed > 0) tangent(:,k) = predicted/speed
        if (speed == 0) tangent(:,k) = cshift(normal, 1)
        slip(:,k) = 0
        slip(1,k) = speed*dt
        stick(k) = mass(jCon(k))*speed/dt
        forceN(k) = pressing(jCon(k))
        dirN(:,k) = normal
        v(:,jCon(k)) = predicted
      end do
      statev = state
      props = constants
      area = 1
      fTangential = 0
      call vfric(fTangential, statev, 1, 1, n, 1, n, 1, nDir-1, nDir,
     1  nState, nProps, 0, 0, 1, jSlv, jMst, jCon, jFacet, real(time,
     2  kind(area)), real(time, kind(area)), real(dt, kind(area)),
     3  surfInt, surfInt, surfInt, 1, slip, stick, before, forceN,
     4  real(0, kind(area)), shape, coordSlv, coordMst, tangent, dirN,
     5  props, area, temp, preDef, tempMst, preDefMst)
      state = statev
      do k = 1, n
        f(:,jCon(k)) = fTangential(1,k)*tangent(:,k)
        if (nDir == 3) then
          across = [dirN(2,k)*tangent(3,k) - dirN(3,k)*tangent(2,k),
     1      dirN(3,k)*tangent(1,k) - dirN(1,k)*tangent(3,k),
     2      dirN(1,k)*tangent(2,k) - dirN(2,k)*tangent(1,k)]
          f(:,jCon(k)) = f(:,jCon(k)) + fTangential(2,k)*across
        end if
        v(:,jCon(k)) = v(:,jCon(k)) + dt/mass(jCon(k))*f(:,jCon(k))
      end do
      end subroutine

C     The error that VFRIC reported, and forgets it; ends with a zero.
      subroutine stub_error(text) bind(c)
      character(kind=c_char) text(513)
      integer k
      do k = 1, 512
        text(k) = last_error(k:k)
      end do
      text(len_trim(last_error) + 1) = c_null_char
      last_error = ' '
      end subroutine
      end module

C     Abaqus' routine, which would end the analysis.
      subroutine xplb_abqerr(lop, string, intv, realv, charv)
      use abaqus_stub, only: last_error
      implicit none
      integer lop, intv
      character(*) string, charv
      real realv
      last_error = string
      end
