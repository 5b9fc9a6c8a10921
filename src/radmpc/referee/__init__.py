"""An independent judge of plans: it knows scenarios and plans, not how plans are made."""

from radmpc.referee.certificate import Certificate, certify

__all__ = ["Certificate", "certify"]
