! Two predators in a chain with their prey, the second one absent
      SUBROUTINE FUNC(NDIM,U,ICP,PAR,IJAC,F,DFDU,DFDP)
      IMPLICIT NONE
      INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC
      DOUBLE PRECISION, INTENT(IN) :: U(NDIM), PAR(*)
      DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)
      DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM,NDIM), DFDP(NDIM,*)
      F(1)=U(1)*(1-U(1))-3*U(1)*U(2)
      F(2)=-U(2)/4+3*U(1)*U(2)-3*U(2)*U(3)-PAR(1)*(1-EXP(-5*U(2)))
      F(3)=-U(3)/2+3*U(2)*U(3)
      IF(IJAC.EQ.0)RETURN
      DFDU(:,:)=0d0
      DFDU(1,1)=1-2*U(1)-3*U(2)
      DFDU(1,2)=-3*U(1)
      DFDU(2,1)=3*U(2)
      DFDU(2,2)=-0.25d0+3*U(1)-3*U(3)-5*PAR(1)*EXP(-5*U(2))
      DFDU(2,3)=-3*U(2)
      DFDU(3,2)=3*U(3)
      DFDU(3,3)=-0.5d0+3*U(2)
      IF(IJAC.EQ.1)RETURN
      DFDP(:,1)=0d0
      DFDP(2,1)=-(1-EXP(-5*U(2)))
      END SUBROUTINE FUNC
      SUBROUTINE STPNT(NDIM,U,PAR,T)
      IMPLICIT NONE
      INTEGER, INTENT(IN) :: NDIM
      DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM),PAR(*)
      DOUBLE PRECISION, INTENT(IN) :: T
      U(1)=0.1d0
      U(2)=0.3d0
      U(3)=0d0
      PAR(1)=(3*U(1)-0.25d0)*U(2)/(1-EXP(-5*U(2)))
      END SUBROUTINE STPNT
      SUBROUTINE BCND
      END SUBROUTINE BCND
      SUBROUTINE ICND
      END SUBROUTINE ICND
      SUBROUTINE FOPT
      END SUBROUTINE FOPT
      SUBROUTINE PVLS
      END SUBROUTINE PVLS
