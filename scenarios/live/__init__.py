"""`sot live` and `sot stream`: a robot that follows a person while the person moves."""
