! Von Mises plasticity with linear isotropic hardening: radial return, consistent tangent, in free form.
! PROPS: Young's modulus, Poisson's ratio, yield stress, hardening modulus. STATEV(1): equivalent plastic strain.
! J. C. Simo, T. J. R. Hughes: Computational Inelasticity (1998), box 3.2.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, kstep, kinc)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep(4), kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt
  real(dp) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3)
  real(dp) :: drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  real(dp) :: g, lambda, bulk, hardening, q, yield, gamma, theta, theta_bar, mean, n(ntens)
  integer :: i, j

  g = props(1) / (2 * (1 + props(2)))
  lambda = 2 * g * props(2) / (1 - 2 * props(2))
  bulk = lambda + 2 * g / 3
  hardening = props(4)
  ddsdde = 0
  ddsdde(1:ndi, 1:ndi) = lambda
  do i = 1, ntens
    ddsdde(i, i) = ddsdde(i, i) + merge(2 * g, g, i <= ndi)
  end do
  stress = stress + matmul(ddsdde, dstran)
  mean = sum(stress(1:3)) / 3
  n = stress
  n(1:3) = n(1:3) - mean
  q = sqrt(1.5d0 * (sum(n(1:3)**2) + 2 * sum(n(4:ntens)**2)))
  yield = props(3) + hardening * statev(1)
  if (q > yield) then
    gamma = (q - yield) / (3 * g + hardening)
    statev(1) = statev(1) + gamma
    n = n * 1.5d0 / q ! the direction of flow; its norm is sqrt(3/2)
    spd = spd + gamma * (yield + hardening * gamma)
    stress = stress - 2 * g * gamma * n
    theta = 1 - 3 * g * gamma / q
    theta_bar = 1 / (1 + hardening / (3 * g)) - (1 - theta)
    ddsdde = 0
    do i = 1, 3
      do j = 1, 3
        ddsdde(i, j) = bulk - 2 * g * theta / 3
      end do
    end do
    do i = 1, ntens
      ddsdde(i, i) = ddsdde(i, i) + merge(2 * g, g, i <= 3) * theta
    end do
    do j = 1, ntens
      do i = 1, ntens
        ddsdde(i, j) = ddsdde(i, j) - 4 * g / 3 * theta_bar * n(i) * n(j)
      end do
    end do
  end if
end subroutine umat
