C vfric.f - friction of a contact pair of Abaqus/Explicit by a law of ilaw, for *FRICTION, USER. See README.md.
C SPDX-License-Identifier: BSD-3-Clause

C     To edit: the law of each surface interaction (its name comes in capital letters), and the parameters of the
C     law from the constants of *FRICTION, USER. The friction of coulomb may fall with the slip speed.
      subroutine choose_law(interaction, nConst, const, law, values)
      use ilaw_vfric, only: ilaw_values
      implicit none
      character(*) interaction, law
      integer nConst
      double precision const(nConst)
      type(ilaw_values) values

      law = 'coulomb'
      if (interaction(1:4) .eq. 'WEAK') law = 'slip_weakening'
      call values%set('friction', const(1))
      call values%set('activation', 'moreau')
      if (law .eq. 'slip_weakening') then
        call values%set('dynamic_friction', const(2))
        call values%set('critical_slip', const(3))
      else if (nConst .ge. 3) then
        call values%set('kinetic_friction', const(2))
        call values%set('decay', const(3))
      end if
      end

      subroutine vfric(fTangential, statev,
     1  kStep, kInc, nContact, nFacNod, nSlvNod, nMstNod,
     2  nFricDir, nDir, nStateVar, nProps, nTemp, nPred, numDefTfv,
     3  jSlvUid, jMstUid, jConSlvid, jConMstid, timStep, timGlb,
     4  dTimCur, surfInt, surfSlv, surfMst, lContType,
     5  dSlipFric, fStickForce, fTangPrev, fNormal, frictionWork,
     6  shape, coordSlv, coordMst, dirCosSl, dircosN, props,
     7  areaSlv, tempSlv, preDefSlv, tempMst, preDefMst)
      use ilaw_vfric, only: friction_law, friction_forces
      include 'vaba_param.inc'
      character*80 surfInt, surfSlv, surfMst
      dimension props(nProps), statev(nStateVar,nSlvNod),
     1  dSlipFric(nDir,nContact), fTangential(nFricDir,nContact),
     2  fTangPrev(nDir,nContact), fStickForce(nContact),
     3  areaSlv(nSlvNod), fNormal(nContact), shape(nFacNod,nContact),
     4  coordSlv(nDir,nSlvNod), coordMst(nDir,nMstNod),
     5  dirCosSl(nDir,nContact), dircosN(nDir,nContact),
     6  jSlvUid(nSlvNod), jMstUid(nMstNod), jConSlvid(nContact),
     7  jConMstid(nFacNod,nContact), tempSlv(nContact),
     8  preDefSlv(nContact,nPred), tempMst(numDefTfv),
     9  preDefMst(numDefTfv,nPred)
      type(friction_law) law
      character*512 message
      double precision f(nFricDir,nContact), memory(nStateVar,nContact)

      call find_law(surfInt, nProps, dble(props), nDir, law, message)
      if (message .eq. ' ') then
        memory = dble(statev(:,jConSlvid))
        call friction_forces(law, dble(timGlb), dble(dTimCur),
     1    dble(dSlipFric(1,:)), dble(fStickForce), dble(fNormal),
     2    dble(dirCosSl), dble(dircosN), dble(areaSlv(jConSlvid)),
     3    memory, f, message)
        statev(:,jConSlvid) = memory
        fTangential = f
      end if
      if (message .ne. ' ') call xplb_abqerr(-3,
     1  'VFRIC, law of ilaw: '//trim(message), 0, 0.0, ' ')
      end

C     The law of a surface interaction, created at its first call.
      subroutine find_law(interaction, nConst, const, nDir, law,
     1  message)
      use ilaw_vfric
      implicit none
      character(*) interaction, message
      integer nConst, nDir, k
      double precision const(nConst)
      type(friction_law) law, laws(100)
      character*80 names(100), name
      integer :: count = 0
      type(ilaw_values) values
      save laws, names, count

      message = ' '
      do k = 1, count
        if (names(k) .eq. interaction) then
          law = laws(k)
          return
        end if
      end do
      if (count .eq. size(laws)) then
        message = 'more than 100 surface interactions'
        return
      end if
      call choose_law(interaction, nConst, const, name, values)
      call create_friction(name, values, nDir, law, message)
      if (message .ne. ' ') return
      count = count + 1
      names(count) = interaction
      laws(count) = law
      end
