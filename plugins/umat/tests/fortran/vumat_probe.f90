! Writes its arguments into stateNew and gives the stress 10, 20, ..., or at time zero that of lambda = 3, mu = 2.
subroutine vumat(jblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal, stepTime, totalTime, dt, cmname, coordMp, charLength, &
    props, density, strainInc, relSpinInc, tempOld, stretchOld, defgradOld, fieldOld, stressOld, stateOld, enerInternOld, &
    enerInelasOld, tempNew, stretchNew, defgradNew, fieldNew, stressNew, stateNew, enerInternNew, enerInelasNew)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer :: jblock(*), ndir, nshr, nstatev, nfieldv, nprops, lanneal
  real(dp) :: stepTime, totalTime, dt
  character(len=*) :: cmname
  real(dp) :: coordMp(jblock(1), 3), charLength(*), props(nprops), density(*), strainInc(jblock(1), ndir + nshr)
  real(dp) :: relSpinInc(jblock(1), nshr), tempOld(*), stretchOld(jblock(1), ndir + nshr), defgradOld(jblock(1), ndir + 2 * nshr)
  real(dp) :: fieldOld(jblock(1), nfieldv), stressOld(jblock(1), ndir + nshr), stateOld(jblock(1), nstatev), enerInternOld(*)
  real(dp) :: enerInelasOld(*), tempNew(*), stretchNew(jblock(1), ndir + nshr), defgradNew(jblock(1), ndir + 2 * nshr)
  real(dp) :: fieldNew(jblock(1), nfieldv), stressNew(jblock(1), ndir + nshr), stateNew(jblock(1), nstatev), enerInternNew(*)
  real(dp) :: enerInelasNew(*)
  integer :: k, i, used

  do k = 1, jblock(1)
    if (totalTime == 0) then
      do i = 1, ndir + nshr
        stressNew(k, i) = stressOld(k, i) + 4 * strainInc(k, i) + merge(3 * sum(strainInc(k, 1:3)), 0.0_dp, i <= 3)
      end do
      cycle
    end if
    used = 0
    stateNew(k, :) = -77
    call see(real([jblock(1:4), jblock(4 + k), ndir, nshr, nstatev, nfieldv, nprops, lanneal], dp))
    call see([stepTime, totalTime, dt, real(len(cmname), dp), real(len_trim(cmname), dp)])
    call see(coordMp(k, :))
    call see([charLength(k)])
    call see(props)
    call see([density(k)])
    call see(strainInc(k, :))
    call see(relSpinInc(k, :))
    call see([tempOld(k), tempNew(k)])
    call see(stretchOld(k, :))
    call see(stretchNew(k, :))
    call see(defgradOld(k, :))
    call see(defgradNew(k, :))
    call see([fieldOld(k, 1), fieldNew(k, 1)])
    call see(stressOld(k, :))
    call see([stateOld(k, 1), enerInternOld(k), enerInelasOld(k)])
    do i = 1, ndir + nshr
      stressNew(k, i) = 10 * i
    end do
    enerInternNew(k) = enerInternOld(k) + 5
    enerInelasNew(k) = enerInelasOld(k) + 6
  end do

contains

  subroutine see(values)
    real(dp), intent(in) :: values(:)
    integer :: n
    do n = 1, size(values)
      stateNew(k, used + n) = values(n)
    end do
    used = used + size(values)
  end subroutine see
end subroutine vumat
