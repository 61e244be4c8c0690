# filled by the installer
